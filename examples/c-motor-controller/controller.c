#include "controller.h"

#include <string.h>

/* Inertia of joint Q1 at the link, motor included: 0.15 + 6 x 6 x (2.5e-4 + the sun's) and the carrier's. */
#define INERTIA_KG_M2 0.160f
#define TURN_RAD 6.2831853f
/* Time constant of the current loop that is modelled. */
#define CURRENT_LAG_S 0.2e-3f

JointStatus controller_start(Controller *controller, const uint64_t *tables, size_t bytes) {
    JointStatus status;
    memset(controller, 0, sizeof *controller);
    status = joint_tables_facts(tables, bytes, &controller->facts);
    if (status == JOINT_STATUS_OK) {
        status = joint_observer_start(&controller->observer, sizeof controller->observer, tables, bytes);
    }
    if (status == JOINT_STATUS_OK) {
        status = joint_compensation_start(&controller->compensation, sizeof controller->compensation, tables, bytes);
    }
    return status;
}

/*
 * Raw counts of two encoders have different zeros. Observer and compensation estimate the difference by themselves; a loop on
 * the motor alone takes it from the first reading, and is off by the place in the gap at that moment.
 */
static void refer_motor_to_link(Controller *controller) {
    const JointShaft *motor = &controller->estimates.motor, *link = &controller->estimates.link;
    const float place_turns = ((float)motor->turns + motor->fraction_turns) / controller->facts.ratio;
    controller->motor_zero_turns = place_turns - ((float)link->turns + link->fraction_turns);
    controller->has_motor_zero = 1;
}

/* The usual: a PID on the motor's place with three poles at the bandwidth, and the acceleration fed forward. */
static float without_compensation(Controller *controller, const JointMotion *now) {
    const JointTablesFacts *facts = &controller->facts;
    const JointShaft *motor = &controller->estimates.motor;
    const float pole = facts->bandwidth_rad_per_s;
    const float place_turns = ((float)motor->turns + motor->fraction_turns) / facts->ratio - controller->motor_zero_turns;
    const float error_rad = TURN_RAD * ((float)now->turns + now->fraction_turns - place_turns);
    const float error_rad_per_s = now->speed_rad_per_s - motor->speed_rad_per_s / facts->ratio;
    const float at_link_Nm =
        INERTIA_KG_M2 * (now->acceleration_rad_per_s2 + 3.0f * pole * error_rad_per_s + 3.0f * pole * pole * error_rad +
                         pole * pole * pole * controller->integral_rad_s);
    const float torque_Nm = at_link_Nm / facts->ratio;
    if (torque_Nm > facts->torque_limit_Nm) {
        return facts->torque_limit_Nm;
    }
    if (torque_Nm < -facts->torque_limit_Nm) {
        return -facts->torque_limit_Nm;
    }
    controller->integral_rad_s += error_rad * facts->period_s;
    return torque_Nm;
}

JointStatus controller_period(Controller *controller, JointSamples *samples, const JointMotion *now,
                              const JointMotion *ahead) {
    JointStatus status;
    float torque_Nm = 0.0f;
    /* The observer wants what was commanded; it knows delay and lag of the loop from its tables. */
    samples->motor_torque_Nm = TORQUE_CONSTANT_NM_PER_A * controller->reference_A;
    status = joint_observer_step(&controller->observer, samples);
    if (status == JOINT_STATUS_OK) {
        status = joint_observer_estimates(&controller->observer, &controller->estimates);
    }
    if (status == JOINT_STATUS_OK && !controller->has_motor_zero) {
        refer_motor_to_link(controller);
    }
    if (status == JOINT_STATUS_OK && controller->mode == MODE_POSITION) {
        status = joint_compensation_follow(&controller->compensation, &controller->observer, now, ahead,
                                           &controller->torque);
        torque_Nm = controller->torque.motor_torque_Nm;
    } else if (status == JOINT_STATUS_OK && controller->mode == MODE_IMPEDANCE) {
        JointImpedance spring;
        memset(&spring, 0, sizeof spring);
        spring.turns = now->turns;
        spring.fraction_turns = now->fraction_turns;
        spring.speed_rad_per_s = now->speed_rad_per_s;
        spring.stiffness_Nm_per_rad = 100.0f;
        spring.damping_Nm_s_per_rad = 3.0f;
        status = joint_compensation_yield(&controller->compensation, &controller->observer, &spring, &controller->torque);
        torque_Nm = controller->torque.motor_torque_Nm;
    } else if (status == JOINT_STATUS_OK) {
        torque_Nm = without_compensation(controller, now);
    }
    if (status != JOINT_STATUS_OK) {
        /* Never go on with a torque that nobody stands by. */
        torque_Nm = 0.0f;
    }
    controller->reference_A = torque_Nm / TORQUE_CONSTANT_NM_PER_A;
    controller->current_A +=
        (controller->reference_A - controller->current_A) * controller->facts.period_s / (CURRENT_LAG_S + controller->facts.period_s);
    return status;
}
