/*
 * Counts the instructions of every call over the closed loop of run.h, by SysTick of an emulated machine on which each
 * instruction takes a fixed time; with MEASURING also those of the core's own steps on the same numbers.
 */
#include "run.h"
#include "say.h"
#include "tables_of_test.h"

#ifndef COUNTS_PER_THOUSAND
#define COUNTS_PER_THOUSAND 10752u
#endif
#define PERIODS 30000u

#define SYST_CSR (*(volatile uint32_t *)0xE000E010u)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014u)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018u)

typedef struct Cost {
    const char *name;
    uint64_t sum;
    uint32_t most, calls;
} Cost;

static uint32_t own;
static Run run;

static uint32_t since(uint32_t before) {
    const uint32_t counts = (before - SYST_CVR) & 0xFFFFFFu;
    const uint32_t instructions = (uint32_t)(((uint64_t)counts * 1000u + COUNTS_PER_THOUSAND / 2u) / COUNTS_PER_THOUSAND);
    return instructions > own ? instructions - own : 0u;
}

static void add(Cost *cost, uint32_t instructions) {
    cost->sum += instructions;
    cost->calls++;
    if (instructions > cost->most) {
        cost->most = instructions;
    }
}

static void tell(const Cost *cost) {
    say("cost;");
    say(cost->name);
    say(";");
    say_decimal(cost->calls == 0u ? 0u : cost->sum / cost->calls);
    say(";");
    say_decimal(cost->most);
    say("\n");
}

#define COUNT(cost, call)                         \
    do {                                          \
        const uint32_t before = SYST_CVR;         \
        const JointStatus status = (call);        \
        add(&(cost), since(before));              \
        if (status != JOINT_STATUS_OK) {          \
            say(joint_status_name(status));       \
            say("\n");                            \
            return 1;                             \
        }                                         \
    } while (0)

#ifdef MEASURING
/* Defined in bindings/c/measuring/bare.rs. */
void joint_bare_samples(const JointSamples *samples, uint64_t *to);
void joint_bare_command(const JointMotion *now, const JointMotion *ahead, uint64_t *to);
void *joint_bare_observer(JointObserver *observer);
const void *joint_bare_estimates(const JointObserver *observer);
void *joint_bare_compensation(JointCompensation *compensation);
void joint_bare_observer_step(void *observer, const uint64_t *from);
void joint_bare_compensation_step(void *compensation, const void *estimates, const uint64_t *command, uint64_t *to);

static JointObserver bare_observer;
static JointCompensation bare_compensation;
static uint64_t samples_room[32], command_room[32], shaped_room[32];
#endif

int main(void) {
    static Cost start_observer = {"joint_observer_start", 0, 0, 0}, step = {"joint_observer_step", 0, 0, 0};
    static Cost estimates = {"joint_observer_estimates", 0, 0, 0}, follow = {"joint_compensation_follow", 0, 0, 0};
    static Cost yield = {"joint_compensation_yield", 0, 0, 0}, plant = {"joint_plant_step", 0, 0, 0};
    static Cost sample = {"joint_plant_samples", 0, 0, 0}, save = {"joint_observer_save", 0, 0, 0};
    static Cost load = {"joint_observer_load", 0, 0, 0}, outputs = {"joint_plant_outputs", 0, 0, 0};
    static uint8_t memory[JOINT_MEMORY_BYTES];
    uint32_t period, before;
    SYST_RVR = 0xFFFFFFu;
    SYST_CVR = 0;
    SYST_CSR = 5;
    before = SYST_CVR;
    own = since(before);
    if (run_start(&run, tables_of_test, sizeof tables_of_test) != JOINT_STATUS_OK) {
        return 1;
    }
    COUNT(start_observer,
          joint_observer_start(&run.observer, sizeof run.observer, tables_of_test, sizeof tables_of_test));
#ifdef MEASURING
    static Cost bare_step = {"core's observer", 0, 0, 0}, bare_follow = {"core's compensation", 0, 0, 0};
    if (joint_observer_start(&bare_observer, sizeof bare_observer, tables_of_test, sizeof tables_of_test) != JOINT_STATUS_OK ||
        joint_compensation_start(&bare_compensation, sizeof bare_compensation, tables_of_test, sizeof tables_of_test) !=
            JOINT_STATUS_OK) {
        return 1;
    }
    void *const core_observer = joint_bare_observer(&bare_observer);
    void *const core_compensation = joint_bare_compensation(&bare_compensation);
    const void *const core_estimates = joint_bare_estimates(&bare_observer);
#endif
    for (period = 0; period < PERIODS; period++) {
        const JointMotion now = run_motion(&run, period), ahead = run_motion(&run, period + run.lead);
        JointPlantOutputs motion;
        JointSamples samples;
        COUNT(sample, joint_plant_samples(&run.plant, &samples));
        if (period >= 15000u && period < 16000u) {
            samples.has_output = 0;
        }
        COUNT(step, joint_observer_step(&run.observer, &samples));
        COUNT(estimates, joint_observer_estimates(&run.observer, &run.estimates));
        if (period >= 25000u) {
            JointImpedance spring;
            memset(&spring, 0, sizeof spring);
            spring.fraction_turns = now.fraction_turns;
            spring.stiffness_Nm_per_rad = 100.0f;
            spring.damping_Nm_s_per_rad = 3.0f;
            COUNT(yield, joint_compensation_yield(&run.compensation, &run.observer, &spring, &run.torque));
        } else {
            COUNT(follow,
                  joint_compensation_follow(&run.compensation, &run.observer, &now, &ahead, &run.torque));
#ifdef MEASURING
            joint_bare_samples(&samples, samples_room);
            joint_bare_command(&now, &ahead, command_room);
            before = SYST_CVR;
            joint_bare_observer_step(core_observer, samples_room);
            add(&bare_step, since(before));
            before = SYST_CVR;
            joint_bare_compensation_step(core_compensation, core_estimates, command_room, shaped_room);
            add(&bare_follow, since(before));
#endif
        }
        COUNT(plant, joint_plant_step(&run.plant, run.torque.motor_torque_Nm, period / 1700u % 2u ? -1.0f : 1.0f));
        COUNT(outputs, joint_plant_outputs(&run.plant, &motion));
#ifdef MEASURING
        if (period == 24999u) {
            step.name = "joint_observer_step all along";
            tell(&step);
            step.name = "joint_observer_step";
        }
#endif
    }
    COUNT(save, joint_observer_save(&run.observer, memory, sizeof memory));
    if (joint_observer_start(&run.observer, sizeof run.observer, tables_of_test, sizeof tables_of_test) != JOINT_STATUS_OK) {
        return 1;
    }
    COUNT(load, joint_observer_load(&run.observer, memory, sizeof memory));
    tell(&step);
    tell(&estimates);
    tell(&follow);
    tell(&yield);
    tell(&plant);
    tell(&sample);
    tell(&outputs);
    tell(&start_observer);
    tell(&save);
    tell(&load);
#ifdef MEASURING
    tell(&bare_step);
    tell(&bare_follow);
#endif
    say("end of measurement\n");
    return 0;
}
