/*
 * The controller as guest of a plain interrupt, against the plant: SysTick is the control period. The link swings by 0.5 rad
 * once a second (test T2 of hil/t2.toml), with compensation and without; what the link's error is after two seconds of
 * learning is printed in thousandths of a milliradian.
 */
#include "controller.h"
#include "say.h"
#include "tables_of_test.h"

#include <math.h>

#ifndef CORE_HZ
#define CORE_HZ 168000000u
#endif
#define TURN_RAD 6.2831853f
#define AMPLITUDE_RAD 0.5f
#define SECONDS 5u

#define SYST_CSR (*(volatile uint32_t *)0xE000E010u)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014u)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018u)

static Controller controller;
static JointPlant plant;
static volatile uint32_t period;
static volatile JointStatus trouble;
static float sum_of_squares, peak_rad, most_A;
static uint32_t counted;

static JointMotion motion(float time_s) {
    const float phase = TURN_RAD * time_s;
    JointMotion motion;
    motion.turns = 0;
    motion.fraction_turns = AMPLITUDE_RAD / TURN_RAD * (1.0f - cosf(phase));
    motion.speed_rad_per_s = AMPLITUDE_RAD * TURN_RAD * sinf(phase);
    motion.acceleration_rad_per_s2 = AMPLITUDE_RAD * TURN_RAD * TURN_RAD * cosf(phase);
    return motion;
}

void SysTick_Handler(void);
void SysTick_Handler(void) {
    const JointTablesFacts *facts = &controller.facts;
    const uint32_t now = period, rate = facts->control_rate_Hz;
    /* Whole seconds do not count in a sine of 1 Hz. */
    const float time_s = (float)(now % rate) * facts->period_s;
    const JointMotion here = motion(time_s), ahead = motion(time_s + facts->lead_s);
    JointPlantOutputs outputs;
    JointSamples samples;
    if (now >= SECONDS * rate || trouble != JOINT_STATUS_OK) {
        return;
    }
    trouble = joint_plant_samples(&plant, &samples);
    if (trouble == JOINT_STATUS_OK) {
        trouble = joint_plant_outputs(&plant, &outputs);
    }
    if (trouble == JOINT_STATUS_OK) {
        trouble = controller_period(&controller, &samples, &here, &ahead);
    }
    if (trouble == JOINT_STATUS_OK) {
        trouble = joint_plant_step(&plant, TORQUE_CONSTANT_NM_PER_A * controller.reference_A, 0.0f);
    }
    if (trouble == JOINT_STATUS_OK && now >= 2u * rate) {
        const float carrier_turns = (float)outputs.carrier_turns + (float)outputs.carrier_fraction / 4294967296.0f;
        const float error_rad = TURN_RAD * (here.fraction_turns - carrier_turns) - outputs.link_offset_rad;
        sum_of_squares += error_rad * error_rad;
        counted++;
        peak_rad = fabsf(error_rad) > peak_rad ? fabsf(error_rad) : peak_rad;
        most_A = fabsf(controller.current_A) > most_A ? fabsf(controller.current_A) : most_A;
    }
    period = now + 1u;
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
    sum_of_squares = peak_rad = most_A = 0.0f;
    counted = period = 0;
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
    tell("rms_urad ", 1e6f * sqrtf(sum_of_squares / (float)counted));
    tell("peak_urad ", 1e6f * peak_rad);
    tell("most_mA ", 1e3f * most_A);
    return 0;
}

int main(void) {
    const int failed = run(MODE_POSITION, "with compensation") + run(MODE_WITHOUT_COMPENSATION, "without compensation") +
                       run(MODE_IMPEDANCE, "impedance");
    say("end of measurement\n");
    return failed;
}
