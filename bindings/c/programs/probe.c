/*
 * Runs the width probe on a plant whose link is held, then saves the memory and loads it into another observer. Prints a
 * digest of all torques and widths, and the width.
 */
#include "expect.h"
#include "run.h"
#include "say.h"
#include "tables_of_test.h"

static JointPlant plant;
static JointObserver observer, other;
static JointProbe probe;

int main(void) {
    const size_t bytes = sizeof tables_of_test;
    uint8_t memory[JOINT_MEMORY_BYTES], again[JOINT_MEMORY_BYTES];
    uint64_t digest = 0x6a6f696e742d3031ull;
    JointProbed probed;
    uint32_t period;
    memset(&probed, 0, sizeof probed);
    if (!is(joint_plant_start(&plant, sizeof plant, tables_of_test, bytes), JOINT_STATUS_OK, "plant") ||
        !is(joint_observer_start(&observer, sizeof observer, tables_of_test, bytes), JOINT_STATUS_OK, "observer") ||
        !is(joint_probe_start(&probe, sizeof probe, tables_of_test, bytes), JOINT_STATUS_OK, "probe")) {
        return 1;
    }
    for (period = 0; period < 10000u; period++) {
        JointSamples samples;
        if (!is(joint_plant_samples(&plant, &samples), JOINT_STATUS_OK, "samples") ||
            !is(joint_observer_step(&observer, &samples), JOINT_STATUS_OK, "step") ||
            !is(joint_probe_step(&probe, &observer, &probed), JOINT_STATUS_OK, "probe") ||
            !is(joint_plant_step(&plant, probed.motor_torque_Nm, 0.0f), JOINT_STATUS_OK, "plant")) {
            return 1;
        }
        digest = run_chain_number(digest, probed.motor_torque_Nm);
        digest = run_chain_number(digest, probed.half_backlash_m.value);
    }
    say("progress ");
    say_decimal(probed.progress);
    say("\nwidth_nm ");
    say_decimal((uint64_t)(1e9f * probed.half_backlash_m.value + 0.5f));
    say("\ndigest ");
    say_hexadecimal(digest);
    say("\n");
    if (!is(joint_observer_save(&observer, memory, sizeof memory), JOINT_STATUS_OK, "save") ||
        !is(joint_observer_start(&other, sizeof other, tables_of_test, bytes), JOINT_STATUS_OK, "other") ||
        !is(joint_observer_load(&other, memory, sizeof memory), JOINT_STATUS_OK, "load") ||
        !is(joint_observer_save(&other, again, sizeof again), JOINT_STATUS_OK, "save again")) {
        return 1;
    }
    say(memcmp(memory, again, sizeof memory) == 0 ? "memory the same\n" : "memory another\n");
    memory[100] ^= 1u;
    if (!is(joint_observer_load(&other, memory, sizeof memory), JOINT_STATUS_DAMAGED_MEMORY, "damaged") ||
        !is(joint_observer_start_without_maps(&other, sizeof other, tables_of_test, bytes), JOINT_STATUS_OK, "plain") ||
        !is(joint_observer_load(&other, again, sizeof again), JOINT_STATUS_OTHER_JOINT, "of an observer with maps")) {
        return 1;
    }
    say("end of measurement\n");
    return 0;
}
