/*
 * A closed loop of plant, observer and compensation with a digest over every period, which shows whether two machines
 * compute the same bits. The motion uses whole numbers and single multiplications only, so that no compiler flag changes
 * it: back and forth by a twentieth of a turn at full acceleration, every other time as spring and damper, with a push that
 * changes its side and an output encoder that stops answering.
 */
#ifndef RUN_H
#define RUN_H

#include <lostmotion/joint.h>

#include <string.h>

/* Around the calls of the library a caller may have the floating-point unit round upwards, which changes every result that is
   not protected from it; whether that mode is still there after them counts, too. */
#ifdef ROUND_UPWARD
#include <fenv.h>
#define RUN_CALLS_BEGIN() (void)fesetround(FE_UPWARD)
#define RUN_CALLS_END(status)                                      \
    do {                                                           \
        if (fegetround() != FE_UPWARD) {                           \
            (status) = 1000u;                                      \
        }                                                          \
        (void)fesetround(FE_TONEAREST);                            \
    } while (0)
#else
#define RUN_CALLS_BEGIN() (void)0
#define RUN_CALLS_END(status) (void)(status)
#endif

typedef struct Run {
    JointPlant plant;
    JointObserver observer;
    JointCompensation compensation;
    uint64_t digest;
    uint32_t period;
    /* Control periods per 0.1 ms. */
    uint32_t scale;
    /* Periods from now to the motion ahead. */
    uint32_t lead;
    /* Estimates and torque of the last period. */
    JointEstimates estimates;
    JointTorque torque;
} Run;

static inline uint64_t run_chain(uint64_t running, uint64_t word) {
    return (((running << 5) | (running >> 59)) ^ word) * 0x9e3779b97f4a7c15ull;
}

static inline uint64_t run_chain_number(uint64_t running, float number) {
    uint32_t bits;
    memcpy(&bits, &number, sizeof bits);
    return run_chain(running, bits);
}

static inline JointMotion run_motion(const Run *run, uint32_t period) {
    const uint32_t scale = run->scale, half = 1250u * scale, segment = 2u * half;
    const uint32_t since = period % segment;
    const uint32_t backwards = period / segment % 2u;
    const uint32_t left = segment - since;
    const uint32_t begun = since < half;
    const uint32_t way = begun ? since * since : 2u * half * half - left * left;
    const uint32_t place = backwards ? 2u * half * half - way : way;
    const int32_t speed = (int32_t)(begun ? since : left) * (backwards ? -1 : 1);
    const float share = scale == 1u ? 1.0f : 0.5f;
    JointMotion motion;
    motion.turns = 0;
    motion.fraction_turns = (float)place * (1.6e-8f * share * share);
    motion.speed_rad_per_s = (float)speed * (0.0020106193f * share);
    motion.acceleration_rad_per_s2 = begun == backwards ? -20.106193f : 20.106193f;
    return motion;
}

static inline JointStatus run_start(Run *run, const uint64_t *tables, size_t bytes) {
    JointTablesFacts facts;
    JointStatus status = joint_tables_facts(tables, bytes, &facts);
    memset(run, 0, sizeof *run);
    if (status == JOINT_STATUS_OK) {
        run->digest = 0x6a6f696e742d3031ull;
        run->scale = facts.control_rate_Hz / 10000u;
        run->lead = (uint32_t)(facts.lead_s * (float)facts.control_rate_Hz);
        status = joint_plant_start(&run->plant, sizeof run->plant, tables, bytes);
    }
    if (status == JOINT_STATUS_OK) {
        status = joint_observer_start(&run->observer, sizeof run->observer, tables, bytes);
    }
    if (status == JOINT_STATUS_OK) {
        status = joint_compensation_start(&run->compensation, sizeof run->compensation, tables, bytes);
    }
    return status;
}

/* Adds the results of a period to the digest. */
static inline void run_note(Run *run, uint64_t plant_digest) {
    const float said[] = {
        run->torque.motor_torque_Nm,          run->torque.trust,
        run->torque.demand_Nm,                run->estimates.gap_m.value,
        run->estimates.gap_m.variance,        run->estimates.half_backlash_m.value,
        run->estimates.load_torque_Nm.value,  run->estimates.compliance_rad_per_Nm.value,
        run->estimates.skew_s.value,          run->estimates.motor.fraction_turns,
        run->estimates.link.speed_rad_per_s,
    };
    size_t index;
    uint64_t digest = run->digest;
    for (index = 0; index < sizeof said / sizeof said[0]; index++) {
        digest = run_chain_number(digest, said[index]);
    }
    digest = run_chain(digest, (uint64_t)run->estimates.contact << 8 | (uint64_t)run->estimates.source);
    run->digest = run_chain(digest, plant_digest);
    run->period++;
}

static inline JointStatus run_period(Run *run) {
    const uint32_t period = run->period, scale = run->scale;
    const JointMotion now = run_motion(run, period), ahead = run_motion(run, period + run->lead);
    const float push_Nm = period / (1700u * scale) % 2u ? -1.0f : 1.0f;
    uint64_t plant_digest = 0;
    JointSamples samples;
    JointStatus status;
    RUN_CALLS_BEGIN();
    status = joint_plant_samples(&run->plant, &samples);
    if (period >= 15000u * scale && period < 16000u * scale) {
        samples.has_output = 0;
    }
    if (status == JOINT_STATUS_OK) {
        status = joint_observer_step(&run->observer, &samples);
    }
    if (status == JOINT_STATUS_OK) {
        if (period / (10000u * scale) % 2u) {
            JointImpedance spring;
            spring.turns = now.turns;
            spring.fraction_turns = now.fraction_turns;
            spring.speed_rad_per_s = now.speed_rad_per_s;
            spring.torque_Nm = 0.0f;
            spring.stiffness_Nm_per_rad = 100.0f;
            spring.damping_Nm_s_per_rad = 3.0f;
            status = joint_compensation_yield(&run->compensation, &run->observer, &spring, &run->torque);
        } else {
            status = joint_compensation_follow(&run->compensation, &run->observer, &now, &ahead, &run->torque);
        }
    }
    if (status == JOINT_STATUS_OK) {
        status = joint_plant_step(&run->plant, run->torque.motor_torque_Nm, push_Nm);
    }
    if (status == JOINT_STATUS_OK) {
        status = joint_observer_estimates(&run->observer, &run->estimates);
    }
    if (status == JOINT_STATUS_OK) {
        status = joint_plant_digest(&run->plant, &plant_digest);
    }
    RUN_CALLS_END(status);
    if (status == JOINT_STATUS_OK) {
        run_note(run, plant_digest);
    }
    return status;
}

#endif
