/*
 * The controller as guest of a plain interrupt, against the plant: SysTick is the control period. The link swings by 0.5 rad
 * once a second (test T2 of hil/t2.toml), with compensation, without, and as a spring and damper; after two seconds of
 * learning the figures of that test are taken, and a digest over everything that was asked for and every bit of the plant.
 *
 * The sine is turned on from period to period by additions and multiplications alone, which every compiler does alike as long
 * as it does not fuse them (-std=c99, or -ffp-contract=off): so the digest is the same on every machine.
 */
#include "controller.h"
#include "say.h"
#include "tables_of_test.h"

#include <math.h>
#include <string.h>

#ifndef CORE_HZ
#define CORE_HZ 168000000u
#endif
#define TURN_RAD 6.2831853f
#define AMPLITUDE_RAD 0.5f
#define SECONDS 5u
/* The encoders of joint Q1 count to 2^14 and 2^17, and are mounted as they come: the motor's reads 0.28 turns and the output's
   0.3 turns where the plant is at zero. */
#define MOTOR_COUNTS 16384u
#define MOTOR_ZERO 4660u
#define OUTPUT_COUNTS 131072u
#define OUTPUT_ZERO 39322u
#define OUTPUT_ZERO_TURNS ((float)OUTPUT_ZERO / (float)OUTPUT_COUNTS)
/* Of joint Q1. A flank counts as touching where this much of the gap is left behind: deflection and transmission error are
   less. */
#define HALF_BACKLASH_M 40e-6f
#define NEAR_M (0.9f * 2.0f * HALF_BACKLASH_M)

#define SYST_CSR (*(volatile uint32_t *)0xE000E010u)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014u)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018u)

typedef struct Angle {
    float cosine, sine;
} Angle;

/* What is judged of a run. */
typedef struct Figures {
    float sum_of_squares, peak_rad, most_A;
    uint32_t counted;
    /* Crossings of the gap, and the periods that they took: together, and the longest. */
    uint32_t crossings, crossed, longest;
    /* The flank that was touched last, 1 or -1, and when. */
    int side;
    uint32_t since;
    uint64_t digest;
} Figures;

static Controller controller;
static JointPlant plant;
static Figures figures;
/* Where the sine is, and by how much a period and the lead turn it on. */
static Angle now_at, one_period, one_lead;
static volatile uint32_t period;
static volatile JointStatus trouble;

/* An angle of less than a radian. */
static Angle angle(float rad) {
    const float square = rad * rad;
    Angle angle;
    angle.sine = rad * (1.0f - square / 6.0f * (1.0f - square / 20.0f * (1.0f - square / 42.0f)));
    angle.cosine = 1.0f - square / 2.0f * (1.0f - square / 12.0f * (1.0f - square / 30.0f * (1.0f - square / 56.0f)));
    return angle;
}

static Angle turned(Angle from, Angle by) {
    Angle to;
    to.cosine = from.cosine * by.cosine - from.sine * by.sine;
    to.sine = from.sine * by.cosine + from.cosine * by.sine;
    return to;
}

/* Wanted position as the plant counts it [turns]. */
static float swing_turns(Angle at) {
    return AMPLITUDE_RAD / TURN_RAD * (1.0f - at.cosine);
}

/* Wanted motion as the output encoder counts it. */
static JointMotion motion(Angle at) {
    JointMotion motion;
    motion.turns = 0;
    motion.fraction_turns = OUTPUT_ZERO_TURNS + swing_turns(at);
    motion.speed_rad_per_s = AMPLITUDE_RAD * TURN_RAD * at.sine;
    motion.acceleration_rad_per_s2 = AMPLITUDE_RAD * TURN_RAD * TURN_RAD * at.cosine;
    return motion;
}

static uint64_t chain(uint64_t running, uint64_t word) {
    return (((running << 5) | (running >> 59)) ^ word) * 0x9e3779b97f4a7c15ull;
}

static void judge(float wanted_turns, const JointPlantOutputs *is) {
    const float carrier_turns = (float)is->carrier_turns + (float)is->carrier_fraction / 4294967296.0f;
    const float error_rad = TURN_RAD * (wanted_turns - carrier_turns) - is->link_offset_rad;
    figures.sum_of_squares += error_rad * error_rad;
    figures.counted++;
    figures.peak_rad = fabsf(error_rad) > figures.peak_rad ? fabsf(error_rad) : figures.peak_rad;
    figures.most_A = fabsf(controller.current_A) > figures.most_A ? fabsf(controller.current_A) : figures.most_A;
    if (fabsf(is->gap_m) > NEAR_M) {
        const int side = is->gap_m > 0.0f ? 1 : -1;
        if (figures.side == -side) {
            const uint32_t took = period - figures.since;
            figures.crossings++;
            figures.crossed += took;
            figures.longest = took > figures.longest ? took : figures.longest;
        }
        figures.side = side;
        figures.since = period;
    }
}

static JointStatus tick(void) {
    const JointMotion here = motion(now_at), ahead = motion(turned(now_at, one_lead));
    JointPlantOutputs outputs;
    JointSamples samples;
    uint64_t digest = 0;
    uint32_t reference;
    JointStatus status = joint_plant_samples(&plant, &samples);
    if (status == JOINT_STATUS_OK) {
        status = joint_plant_outputs(&plant, &outputs);
    }
    if (status == JOINT_STATUS_OK) {
        samples.motor.counts = (samples.motor.counts + MOTOR_ZERO) % MOTOR_COUNTS;
        samples.output.counts = (samples.output.counts + OUTPUT_ZERO) % OUTPUT_COUNTS;
        status = controller_period(&controller, &samples, &here, &ahead);
    }
    if (status == JOINT_STATUS_OK) {
        status = joint_plant_step(&plant, TORQUE_CONSTANT_NM_PER_A * controller.reference_A, 0.0f);
    }
    if (status == JOINT_STATUS_OK) {
        status = joint_plant_digest(&plant, &digest);
    }
    if (status != JOINT_STATUS_OK) {
        return status;
    }
    memcpy(&reference, &controller.reference_A, sizeof reference);
    figures.digest = chain(chain(figures.digest, reference), digest);
    if (period >= 2u * controller.facts.control_rate_Hz) {
        judge(swing_turns(now_at), &outputs);
    }
    return status;
}

void SysTick_Handler(void);
void SysTick_Handler(void) {
    const uint32_t rate = controller.facts.control_rate_Hz;
    if (period >= SECONDS * rate || trouble != JOINT_STATUS_OK) {
        return;
    }
    trouble = tick();
    period = period + 1u;
    now_at = turned(now_at, one_period);
    if (period % rate == 0u) {
        /* A whole turn: what rounding has added up goes. */
        now_at = angle(0.0f);
    }
}

static void tell(const char *what, float value) {
    say(what);
    say_decimal((uint64_t)(value + 0.5f));
    say("\n");
}

static int run(Mode mode, const char *name) {
    JointStatus status = controller_start(&controller, tables_of_test, sizeof tables_of_test);
    if (status == JOINT_STATUS_OK) {
        status = joint_plant_start(&plant, sizeof plant, tables_of_test, sizeof tables_of_test);
    }
    controller.mode = mode;
    trouble = status;
    memset(&figures, 0, sizeof figures);
    period = 0;
    now_at = angle(0.0f);
    one_period = angle(TURN_RAD * controller.facts.period_s);
    one_lead = angle(TURN_RAD * controller.facts.lead_s);
    if (status == JOINT_STATUS_OK) {
        SYST_RVR = CORE_HZ / controller.facts.control_rate_Hz - 1u;
        SYST_CVR = 0;
        SYST_CSR = 7;
        while (period < SECONDS * controller.facts.control_rate_Hz && trouble == JOINT_STATUS_OK) {
            __asm__ volatile("wfi");
        }
        SYST_CSR = 0;
    }
    say(name);
    say("\n");
    if (trouble != JOINT_STATUS_OK) {
        say(joint_status_name(trouble));
        say("\n");
        return 1;
    }
    tell("rms_urad ", 1e6f * sqrtf(figures.sum_of_squares / (float)figures.counted));
    tell("peak_urad ", 1e6f * figures.peak_rad);
    tell("most_mA ", 1e3f * figures.most_A);
    tell("crossings ", (float)figures.crossings);
    if (figures.crossings > 0u) {
        const float us_per_period = 1e6f * controller.facts.period_s;
        tell("lost_motion_us ", us_per_period * (float)figures.crossed / (float)figures.crossings);
        tell("longest_lost_motion_us ", us_per_period * (float)figures.longest);
    }
    say("digest ");
    say_hexadecimal(figures.digest);
    say("\n");
    return 0;
}

int main(void) {
    const int failed = run(MODE_POSITION, "with compensation") + run(MODE_WITHOUT_COMPENSATION, "without compensation") +
                       run(MODE_IMPEDANCE, "impedance");
    say("end of measurement\n");
    return failed;
}
