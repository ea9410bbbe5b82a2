/* Plant as an FMU: torques in; angles, gap, contacts, mesh forces and encoder readings out. */
#include "instance.h"

JointStatus model_start(Model *model) {
    return joint_plant_start(&model->objects.plant, sizeof model->objects.plant, tables, sizeof tables);
}

JointStatus model_period(Model *model) {
    const double *const values = model->values;
    return joint_plant_step(&model->objects.plant, (float)values[VALUE_motor_torque], (float)values[VALUE_external_torque]);
}

/* Force of a mesh by its mean stiffness: zero within the backlash. */
static double mesh_force(double deflection_m, double half_backlash_m, double stiffness_N_per_m) {
    const double excess = deflection_m > half_backlash_m    ? deflection_m - half_backlash_m
                          : deflection_m < -half_backlash_m ? deflection_m + half_backlash_m
                                                            : 0.0;
    return stiffness_N_per_m * excess;
}

JointStatus model_outputs(Model *model) {
    double *const values = model->values;
    JointPlantOutputs motion;
    JointSamples samples;
    float motor_speed = 0.0f, link_speed = 0.0f;
    double carrier_rad;
    unsigned planet;
    JointStatus status = joint_plant_outputs(&model->objects.plant, &motion);
    if (status == JOINT_STATUS_OK) {
        status = joint_plant_samples(&model->objects.plant, &samples);
    }
    if (status == JOINT_STATUS_OK) {
        status = joint_plant_speeds(&model->objects.plant, &motor_speed, &link_speed);
    }
    if (status != JOINT_STATUS_OK) {
        return status;
    }
    carrier_rad = ((double)motion.carrier_turns + (double)motion.carrier_fraction / 4294967296.0) * TURN_RAD;
    values[VALUE_motor_angle] = RATIO * carrier_rad + (double)motion.motor_offset_rad;
    values[VALUE_link_angle] = carrier_rad + (double)motion.link_offset_rad;
    values[VALUE_motor_speed] = (double)motor_speed;
    values[VALUE_link_speed] = (double)link_speed;
    values[VALUE_carrier_speed] = (double)motion.carrier_speed_rad_per_s;
    values[VALUE_gap] = (double)motion.gap_m;
    values[VALUE_wind_up] = (double)motion.wind_up_m;
    values[VALUE_air_gap_torque] = (double)motion.air_gap_torque_Nm;
    values[VALUE_drive_torque] = (double)motion.drive_torque_Nm;
    values[VALUE_braking_torque] = (double)motion.load_torque_Nm;
    values[VALUE_motor_counts] = (double)samples.motor.counts;
    values[VALUE_motor_age] = (double)(samples.time_ticks - samples.motor.time_ticks);
    values[VALUE_output_valid] = samples.has_output != 0 ? 1.0 : 0.0;
    values[VALUE_output_counts] = (double)samples.output.counts;
    values[VALUE_output_age] = (double)(samples.time_ticks - samples.output.time_ticks);
    for (planet = 0; planet < PLANETS; planet++) {
        const double sun_m = (double)motion.sun_deflections_m[planet], ring_m = (double)motion.ring_deflections_m[planet];
        values[VALUE_sun_force + planet] = mesh_force(sun_m, sun_half_backlash_m[planet], SUN_STIFFNESS_N_PER_M);
        values[VALUE_ring_force + planet] = mesh_force(ring_m, ring_half_backlash_m[planet], RING_STIFFNESS_N_PER_M);
        values[VALUE_sun_contact + planet] = side_of(motion.sun_contacts[planet]);
        values[VALUE_ring_contact + planet] = side_of(motion.ring_contacts[planet]);
    }
    return JOINT_STATUS_OK;
}
