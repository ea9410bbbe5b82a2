/*
 * The observer alone, on a PC: reads a recorded log from the standard input and prints the gap. Columns as those of
 * `joint identify`: time_s, motor_counts, output_counts, motor_torque_N_m, a row each control period.
 */
#include <lostmotion/joint.h>
#include "tables_of_test.h"

#include <stdio.h>
#include <string.h>

int main(void) {
    static JointObserver observer;
    JointTablesFacts facts;
    JointEstimates estimates;
    char line[256];
    unsigned long row = 0;
    JointStatus status = joint_tables_facts(tables_of_test, sizeof tables_of_test, &facts);
    if (status == JOINT_STATUS_OK) {
        status = joint_observer_start(&observer, sizeof observer, tables_of_test, sizeof tables_of_test);
    }
    if (fgets(line, sizeof line, stdin) == NULL) {
        fprintf(stderr, "no log: give one on the standard input\n");
        return 2;
    }
    printf("time_s,gap_um,gap_valid,contact,half_backlash_um\n");
    while (status == JOINT_STATUS_OK && fgets(line, sizeof line, stdin) != NULL) {
        double time_s, torque_Nm;
        long motor, output;
        JointSamples samples;
        if (sscanf(line, "%lf,%ld,%ld,%lf", &time_s, &motor, &output, &torque_Nm) != 4) {
            fprintf(stderr, "line %lu is no row of four numbers: %s", row + 2, line);
            return 2;
        }
        memset(&samples, 0, sizeof samples);
        samples.time_ticks = (uint32_t)(time_s * facts.clock_rate_Hz + 0.5);
        samples.motor.counts = (uint32_t)motor;
        samples.output.counts = (uint32_t)output;
        samples.motor.time_ticks = samples.output.time_ticks = samples.time_ticks;
        samples.has_output = 1;
        samples.motor_torque_Nm = (float)torque_Nm;
        status = joint_observer_step(&observer, &samples);
        if (status == JOINT_STATUS_OK) {
            status = joint_observer_estimates(&observer, &estimates);
        }
        if (status == JOINT_STATUS_OK && ++row % 100 == 0) {
            printf("%.4f,%.2f,%u,%u,%.2f\n", time_s, 1e6 * (double)estimates.gap_m.value,
                   (unsigned)estimates.gap_m.valid, (unsigned)(estimates.contact_valid ? estimates.contact : JOINT_CONTACT_SEPARATED),
                   1e6 * (double)estimates.half_backlash_m.value);
        }
    }
    if (status != JOINT_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", joint_status_name(status), joint_status_text(status));
        return 1;
    }
    return 0;
}
