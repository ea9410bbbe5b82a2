/*
 * A small motor controller with a geared joint behind it: a model of its current loop, and around that position control with
 * and without compensation of the lost motion, and impedance control. Once a control period, from a plain interrupt.
 */
#ifndef CONTROLLER_H
#define CONTROLLER_H

#include <lostmotion/joint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum Mode { MODE_POSITION, MODE_IMPEDANCE, MODE_WITHOUT_COMPENSATION } Mode;

typedef struct Controller {
    JointObserver observer;
    JointCompensation compensation;
    JointTablesFacts facts;
    JointEstimates estimates;
    JointTorque torque;
    Mode mode;
    /* The current that is asked for, and what the model of the loop says flows. */
    float reference_A, current_A;
    /* Of the PID without compensation: its integral, and the angle that the motor reads at the output where the link reads zero. */
    float integral_rad_s, motor_zero_turns;
    int has_motor_zero;
} Controller;

/* Of the motor. A power of two loses no bit on the way from torque to current and back. */
#define TORQUE_CONSTANT_NM_PER_A 0.125f

JointStatus controller_start(Controller *controller, const uint64_t *tables, size_t bytes);

/*
 * One control period: what the encoders read (its torque is filled in here, from the current that was asked for), where the
 * link shall be now and by facts.lead_s later. The current to ask for is in reference_A.
 */
JointStatus controller_period(Controller *controller, JointSamples *samples, const JointMotion *now,
                              const JointMotion *ahead);

#ifdef __cplusplus
}
#endif

#endif
