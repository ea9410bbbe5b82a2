/*
 * Measures the stack that every call needs below its caller, including arguments on the stack: paints the free stack before
 * a call and finds the lowest overwritten word after it. Calls of a control period are measured over one second of the
 * closed loop of run.h.
 */
#include "run.h"
#include "say.h"
#include "tables_of_test.h"

#define PAINT 0xC5A35AC5u
#define PERIODS 10000u
/* Painted words: for calls that start, save or load, and for calls of a control period. */
#define MOST 4096u
#define MOST_OF_A_PERIOD 1024u

typedef JointStatus (*Call)(void);

typedef struct Stack {
    const char *name;
    Call call;
    uint32_t bytes;
} Stack;

static Run run;
static JointMotion now, ahead;
static JointImpedance spring;
static JointSamples samples;
static JointTablesFacts facts;
static JointProbe probe;
static JointProbed probed;
static JointPlantOutputs outputs;
static JointWiring wiring;
static JointWiringStep wiring_step;
static JointWiringVerdicts verdicts;
static uint64_t digest;
static uint8_t memory[JOINT_MEMORY_BYTES];
static uint32_t state[JOINT_PLANT_STATE_WORDS];
static uint32_t observer_state[JOINT_OBSERVER_STATE_WORDS], compensation_state[JOINT_COMPENSATION_STATE_WORDS];
static float link_torque, speeds[2];
static JointObserver other;

#define TABLES tables_of_test, sizeof tables_of_test

static JointStatus tables_facts(void) { return joint_tables_facts(TABLES, &facts); }
static JointStatus observer_start(void) { return joint_observer_start(&run.observer, sizeof run.observer, TABLES); }
static JointStatus plain_start(void) { return joint_observer_start_without_maps(&other, sizeof other, TABLES); }
static JointStatus other_start(void) { return joint_observer_start(&other, sizeof other, TABLES); }
static JointStatus compensation_start(void) {
    return joint_compensation_start(&run.compensation, sizeof run.compensation, TABLES);
}
static JointStatus probe_start(void) { return joint_probe_start(&probe, sizeof probe, TABLES); }
static JointStatus plant_start(void) { return joint_plant_start(&run.plant, sizeof run.plant, TABLES); }
static JointStatus wiring_start(void) { return joint_wiring_start(&wiring, sizeof wiring, TABLES); }
static JointStatus observer_step(void) { return joint_observer_step(&run.observer, &samples); }
static JointStatus observer_estimates(void) { return joint_observer_estimates(&run.observer, &run.estimates); }
static JointStatus observer_save(void) { return joint_observer_save(&run.observer, memory, sizeof memory); }
static JointStatus observer_load(void) { return joint_observer_load(&other, memory, sizeof memory); }
static JointStatus observer_save_state(void) {
    return joint_observer_save_state(&run.observer, observer_state, JOINT_OBSERVER_STATE_WORDS);
}
static JointStatus observer_load_state(void) {
    return joint_observer_load_state(&run.observer, observer_state, JOINT_OBSERVER_STATE_WORDS);
}
static JointStatus compensation_save_state(void) {
    return joint_compensation_save_state(&run.compensation, compensation_state, JOINT_COMPENSATION_STATE_WORDS);
}
static JointStatus compensation_load_state(void) {
    return joint_compensation_load_state(&run.compensation, compensation_state, JOINT_COMPENSATION_STATE_WORDS);
}
static JointStatus follow(void) {
    return joint_compensation_follow(&run.compensation, &run.observer, &now, &ahead, &run.torque);
}
static JointStatus yield(void) { return joint_compensation_yield(&run.compensation, &run.observer, &spring, &run.torque); }
static JointStatus probe_step(void) { return joint_probe_step(&probe, &run.observer, &probed); }
static JointStatus plant_step(void) { return joint_plant_step(&run.plant, run.torque.motor_torque_Nm, 0.0f); }
static JointStatus plant_step_with_link(void) {
    return joint_plant_step_with_link(&run.plant, run.torque.motor_torque_Nm, 5.0f, 0.0f, &link_torque);
}
static JointStatus plant_speeds(void) { return joint_plant_speeds(&run.plant, &speeds[0], &speeds[1]); }
static JointStatus plant_shift(void) { return joint_plant_shift(&run.plant, 0, 0.0f, 0.0f); }
static JointStatus plant_save(void) { return joint_plant_save(&run.plant, state, JOINT_PLANT_STATE_WORDS); }
static JointStatus plant_load(void) { return joint_plant_load(&run.plant, state, JOINT_PLANT_STATE_WORDS); }
static JointStatus plant_samples(void) { return joint_plant_samples(&run.plant, &samples); }
static JointStatus plant_outputs(void) { return joint_plant_outputs(&run.plant, &outputs); }
static JointStatus plant_digest(void) { return joint_plant_digest(&run.plant, &digest); }
static JointStatus check_step(void) { return joint_wiring_step(&wiring, &samples, 0.0f, &wiring_step); }
static JointStatus check_verdicts(void) { return joint_wiring_verdicts(&wiring, &verdicts); }

/* Calls that start objects come first, in a valid order. */
static Stack starting[] = {
    {"joint_tables_facts", tables_facts, 0},
    {"joint_plant_start", plant_start, 0},
    {"joint_observer_start", observer_start, 0},
    {"joint_observer_start_without_maps", plain_start, 0},
    {"joint_compensation_start", compensation_start, 0},
    {"joint_probe_start", probe_start, 0},
    {"joint_wiring_start", wiring_start, 0},
};

static Stack running[] = {
    {"joint_plant_samples", plant_samples, 0},
    {"joint_observer_step", observer_step, 0},
    {"joint_observer_estimates", observer_estimates, 0},
    {"joint_compensation_follow", follow, 0},
    {"joint_compensation_yield", yield, 0},
    {"joint_wiring_step", check_step, 0},
    {"joint_plant_step", plant_step, 0},
    {"joint_plant_outputs", plant_outputs, 0},
    {"joint_plant_digest", plant_digest, 0},
    {"joint_plant_speeds", plant_speeds, 0},
};

/* Instead of the compensation. */
static Stack probing[] = {
    {"joint_probe_step", probe_step, 0},
};

static Stack ending[] = {
    {"joint_wiring_verdicts", check_verdicts, 0},
    {"joint_observer_save", observer_save, 0},
    {"joint_observer_load", observer_load, 0},
    {"joint_observer_save_state", observer_save_state, 0},
    {"joint_observer_load_state", observer_load_state, 0},
    {"joint_compensation_save_state", compensation_save_state, 0},
    {"joint_compensation_load_state", compensation_load_state, 0},
    {"joint_plant_step_with_link", plant_step_with_link, 0},
    {"joint_plant_shift", plant_shift, 0},
    {"joint_plant_save", plant_save, 0},
    {"joint_plant_load", plant_load, 0},
};

__attribute__((noinline)) static JointStatus measure(Stack *stack, uint32_t words) {
    volatile uint32_t *top, *at;
    JointStatus status;
    uint32_t bytes;
    __asm__ volatile("mov %0, sp" : "=r"(top));
    for (at = top - words; at < top; at++) {
        *at = PAINT;
    }
    status = stack->call();
    for (at = top - words; at < top && *at == PAINT; at++) {
    }
    bytes = (uint32_t)((uintptr_t)top - (uintptr_t)at);
    stack->bytes = bytes > stack->bytes ? bytes : stack->bytes;
    return status;
}

static void tell(const Stack *stack, uint32_t words) {
    say("stack;");
    say(stack->name);
    say(";");
    /* If every painted word was overwritten, the call may have used more. */
    say_decimal(stack->bytes >= 4u * words ? 0u : stack->bytes);
    say("\n");
}

#define MEASURE(stacks, words)                                              \
    for (index = 0; index < sizeof stacks / sizeof stacks[0]; index++) {    \
        const JointStatus status = measure(&stacks[index], words);          \
        if (status != JOINT_STATUS_OK) {                                    \
            say(stacks[index].name);                                        \
            say(": ");                                                      \
            say(joint_status_name(status));                                 \
            say("\n");                                                      \
            return 1;                                                       \
        }                                                                   \
    }
#define TELL(stacks, words)                                                 \
    for (index = 0; index < sizeof stacks / sizeof stacks[0]; index++) {    \
        tell(&stacks[index], words);                                        \
    }

int main(void) {
    size_t index;
    uint32_t period;
    MEASURE(starting, MOST)
    run.scale = facts.control_rate_Hz / 10000u;
    for (period = 0; period < PERIODS; period++) {
        now = run_motion(&run, period);
        ahead = run_motion(&run, period + (uint32_t)(facts.lead_s * (float)facts.control_rate_Hz));
        spring.turns = now.turns;
        spring.fraction_turns = now.fraction_turns;
        spring.stiffness_Nm_per_rad = 100.0f;
        spring.damping_Nm_s_per_rad = 3.0f;
        MEASURE(running, MOST_OF_A_PERIOD)
    }
    if (plant_start() != JOINT_STATUS_OK || observer_start() != JOINT_STATUS_OK || probe_start() != JOINT_STATUS_OK) {
        return 1;
    }
    for (period = 0; period < PERIODS; period++) {
        run.torque.motor_torque_Nm = probed.motor_torque_Nm;
        if (plant_samples() != JOINT_STATUS_OK || observer_step() != JOINT_STATUS_OK || plant_step() != JOINT_STATUS_OK) {
            return 1;
        }
        MEASURE(probing, MOST_OF_A_PERIOD)
    }
    if (other_start() != JOINT_STATUS_OK) {
        return 1;
    }
    MEASURE(ending, MOST)
    TELL(starting, MOST)
    TELL(running, MOST_OF_A_PERIOD)
    TELL(probing, MOST_OF_A_PERIOD)
    TELL(ending, MOST)
    say("end of measurement\n");
    return 0;
}
