/*
 * Observer and compensation as an FMU: encoder counts and a set-point in, motor torque and estimates out. The readings are
 * those at the begin of a communication step; in its later control periods they have grown older.
 */
#include "instance.h"

#include <string.h>

JointStatus model_start(Model *model) {
    JointStatus status = joint_observer_start(&model->objects.observer, sizeof model->objects.observer, tables, sizeof tables);
    memset(&model->objects.torque, 0, sizeof model->objects.torque);
    if (status == JOINT_STATUS_OK) {
        status = joint_compensation_start(&model->objects.compensation, sizeof model->objects.compensation, tables, sizeof tables);
    }
    return status;
}

/* Splits an angle into whole turns and the rest. Inputs are limited to the turns that 32 bits hold. */
static void set_turns(double angle_rad, int32_t *turns, float *fraction) {
    const double all = angle_rad / TURN_RAD;
    *turns = (int32_t)all;
    *fraction = (float)(all - (double)*turns);
}

static JointMotion motion_of(const double *angle_speed_acceleration) {
    JointMotion motion;
    set_turns(angle_speed_acceleration[0], &motion.turns, &motion.fraction_turns);
    motion.speed_rad_per_s = (float)angle_speed_acceleration[1];
    motion.acceleration_rad_per_s2 = (float)angle_speed_acceleration[2];
    return motion;
}

static JointStatus command(Model *model) {
    Objects *const own = &model->objects;
    const double *const values = model->values;
    if (values[VALUE_impedance] != 0.0) {
        JointImpedance spring;
        set_turns(values[VALUE_target_angle], &spring.turns, &spring.fraction_turns);
        spring.speed_rad_per_s = (float)values[VALUE_target_speed];
        spring.torque_Nm = (float)values[VALUE_link_torque];
        spring.stiffness_Nm_per_rad = (float)values[VALUE_stiffness];
        spring.damping_Nm_s_per_rad = (float)values[VALUE_damping];
        return joint_compensation_yield(&own->compensation, &own->observer, &spring, &own->torque);
    } else {
        const JointMotion now = motion_of(&values[VALUE_target_angle]), ahead = motion_of(&values[VALUE_ahead_angle]);
        return joint_compensation_follow(&own->compensation, &own->observer, &now,
                                         values[VALUE_ahead_valid] != 0.0 ? &ahead : NULL, &own->torque);
    }
}

JointStatus model_period(Model *model) {
    Objects *const own = &model->objects;
    const double *const values = model->values;
    /* Ticks since the communication step began, when the readings were taken. */
    const uint32_t grown = (uint32_t)(model->periods - model->step_began) * TICKS_PER_PERIOD;
    JointSamples samples;
    JointStatus status;
    samples.time_ticks = (uint32_t)model->periods * TICKS_PER_PERIOD;
    samples.motor.counts = (uint32_t)values[VALUE_motor_counts];
    samples.motor.time_ticks = samples.time_ticks - grown - (uint32_t)values[VALUE_motor_age];
    samples.output.counts = (uint32_t)values[VALUE_output_counts];
    samples.output.time_ticks = samples.time_ticks - grown - (uint32_t)values[VALUE_output_age];
    samples.has_output = values[VALUE_output_valid] != 0.0;
    samples.motor_torque_Nm = own->torque.motor_torque_Nm;
    status = joint_observer_step(&own->observer, &samples);
    return status == JOINT_STATUS_OK ? command(model) : status;
}

static double angle_of(const JointShaft *shaft) {
    return ((double)shaft->turns + (double)shaft->fraction_turns) * TURN_RAD;
}

static void set_estimate(double *value_variance_valid, const JointEstimate *estimate) {
    value_variance_valid[0] = (double)estimate->value;
    value_variance_valid[1] = (double)estimate->variance;
    value_variance_valid[2] = (double)estimate->valid;
}

JointStatus model_outputs(Model *model) {
    double *const values = model->values;
    const JointTorque *const torque = &model->objects.torque;
    JointEstimates found;
    const JointStatus status = joint_observer_estimates(&model->objects.observer, &found);
    if (status != JOINT_STATUS_OK) {
        return status;
    }
    values[VALUE_motor_torque] = (double)torque->motor_torque_Nm;
    values[VALUE_trust] = (double)torque->trust;
    values[VALUE_stage] = (double)torque->stage;
    values[VALUE_demand] = (double)torque->demand_Nm;
    set_estimate(&values[VALUE_estimated_gap], &found.gap_m);
    set_estimate(&values[VALUE_estimated_half_backlash], &found.half_backlash_m);
    set_estimate(&values[VALUE_estimated_load_torque], &found.load_torque_Nm);
    set_estimate(&values[VALUE_estimated_mesh_torque], &found.mesh_torque_Nm);
    values[VALUE_estimated_gap_rate] = (double)found.gap_rate_m_per_s;
    values[VALUE_estimated_contact] = side_of(found.contact);
    values[VALUE_estimated_contact_valid] = (double)found.contact_valid;
    values[VALUE_estimated_motor_angle] = angle_of(&found.motor);
    values[VALUE_estimated_motor_speed] = (double)found.motor.speed_rad_per_s;
    values[VALUE_estimated_link_angle] = angle_of(&found.link);
    values[VALUE_estimated_link_speed] = (double)found.link.speed_rad_per_s;
    values[VALUE_source] = (double)found.source;
    values[VALUE_motor_fault] = (double)found.motor_fault;
    values[VALUE_output_fault] = (double)found.output_fault;
    values[VALUE_notices] = (double)found.notices;
    return JOINT_STATUS_OK;
}
