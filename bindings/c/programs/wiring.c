/*
 * Runs the wiring check on a plant: wired correctly, and with output encoder, motor encoder or torque reversed. Prints a
 * digest of all torques, and the verdicts of each check.
 */
#include "expect.h"
#include "run.h"
#include "say.h"
#include "tables_of_test.h"

static JointPlant plant;
static JointWiring wiring;

enum { RIGHT, OUTPUT_REVERSED, MOTOR_REVERSED, TORQUE_REVERSED, MISWIRINGS };

int main(void) {
    const size_t bytes = sizeof tables_of_test;
    uint64_t digest = 0x6a6f696e742d3031ull;
    unsigned miswiring, item;
    if (!is(joint_wiring_step(&wiring, NULL, 0.0f, NULL), JOINT_STATUS_NOT_STARTED, "not started")) {
        return 1;
    }
    for (miswiring = 0; miswiring < MISWIRINGS; miswiring++) {
        JointWiringVerdicts found;
        JointWiringStep step;
        uint32_t period;
        memset(&step, 0, sizeof step);
        if (!is(joint_plant_start(&plant, sizeof plant, tables_of_test, bytes), JOINT_STATUS_OK, "plant") ||
            !is(joint_wiring_start(&wiring, sizeof wiring, tables_of_test, bytes), JOINT_STATUS_OK, "wiring")) {
            return 1;
        }
        for (period = 0; period < 200000u && step.progress == JOINT_WIRING_PROGRESS_RUNNING; period++) {
            const float sign = miswiring == TORQUE_REVERSED ? -1.0f : 1.0f;
            JointSamples samples;
            if (!is(joint_plant_samples(&plant, &samples), JOINT_STATUS_OK, "samples")) {
                return 1;
            }
            if (miswiring == OUTPUT_REVERSED) {
                samples.output.counts = 0x1ffffu - samples.output.counts;
            } else if (miswiring == MOTOR_REVERSED) {
                samples.motor.counts = 0x3fffu - samples.motor.counts;
            }
            samples.motor_torque_Nm = step.motor_torque_Nm;
            if (!is(joint_wiring_step(&wiring, &samples, 0.5f, &step), JOINT_STATUS_OK, "step") ||
                !is(joint_plant_step(&plant, sign * step.motor_torque_Nm, 0.0f), JOINT_STATUS_OK, "plant")) {
                return 1;
            }
            digest = run_chain_number(digest, step.motor_torque_Nm);
        }
        if (!is(joint_wiring_verdicts(&wiring, &found), JOINT_STATUS_OK, "verdicts")) {
            return 1;
        }
        say("progress ");
        say_decimal(step.progress);
        say(found.all_right ? ", all right" : ", bad:");
        for (item = 0; item < JOINT_WIRING_ITEMS; item++) {
            if (found.verdicts[item] == JOINT_VERDICT_WRONG || found.verdicts[item] == JOINT_VERDICT_SUSPECT) {
                say(" ");
                say(joint_wiring_item_name(item));
            }
        }
        say("\n");
    }
    say("digest ");
    say_hexadecimal(digest);
    say("\nend of measurement\n");
    return 0;
}
