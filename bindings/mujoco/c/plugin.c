/*
 * A geared joint with backlash as an actuator of MuJoCo: current loop, rotor, gap, gears and compliance are stepped inside
 * each step of MuJoCo; the link is MuJoCo's.
 *
 * Step, for the step size h of MuJoCo and the joint angle q and speed v at its start:
 *
 *     angle  = q - v h/2                                                  (1)
 *     acc    = torque inverse_inertia + smooth + residual + correction    (2)
 *     force  = mean of torque over the step                               (3)
 *
 * (1) MuJoCo adds the new speed to the angle: q is the angle half a step later than v. Corrected, both are of one time, and
 * error and energy are of second order in h. (2) Acceleration of the link in every control period within the step, with
 * the present torque of the gears; inverse_inertia = moment M^-1 moment^T is what the actuator sees, `smooth` the
 * acceleration by passive, applied and bias forces. A link that is held over the step instead makes a stiff joint unstable.
 * `residual` is the acceleration by other actuators, constraints and contacts: the smaller of the last two steps', and zero
 * if their signs differ, so that an impact is not expected to come again. `correction` takes the link of the gears to the
 * angle and speed of MuJoCo's within two steps: (1.5 speed error + angle error/h)/h.
 *
 * With the key `controller` in an instance, observer and compensation run in every control period within the step: encoder
 * readings of the joint, estimates, torque of the motor, gears. The control is then the angle of the link that is wanted at
 * the start of the step; speed and acceleration come from the last three controls c, c1, c2:
 *
 *     v = (3 c - 4 c1 + c2)/(2 h),    a = (c - 2 c1 + c2)/h^2              (4)
 *
 * An acceleration that the motor cannot give even to the link alone is a jump: speed and acceleration are then zero.
 *
 * The state is in plugin_state only: saved and restored states continue with equal bits, in another process too.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lostmotion/joint.h>
#include <mujoco/mujoco.h>

#include "description.h"

/* Since MuJoCo 4 an actuator may have several controls and forces. */
#ifdef ACTUATORS_HAVE_OUTPUTS
#define ACTUATORS(model) (model)->nactuator
#define CONTROL(model, actuator) (model)->actuator_ctrladr[actuator]
#define LIMITS(control, actuator) (control)
#define OUTPUT(model, actuator) (model)->actuator_outadr[actuator]
#else
#define ACTUATORS(model) (model)->nu
#define CONTROL(model, actuator) (actuator)
#define LIMITS(control, actuator) (actuator)
#define OUTPUT(model, actuator) (actuator)
#endif

#define TURN_RAD 6.283185307179586
/* Angle error beyond which the angle of the joint was set from outside, on top of what the speeds explain [rad]. */
#define SET_RAD 1e-3
/* Deviation of MuJoCo's step from whole control periods [periods]. */
#define MOST_DEVIATION 1e-6

/* Numbers in plugin_state: words of the plant, then: */
enum {
    STARTED = JOINT_PLANT_STATE_WORDS,
    SPEED,     /* of the link at the last step [rad/s] */
    PREDICTED, /* acceleration over the last step without residual [rad/s2] */
    RESIDUALS, /* of the last two steps [rad/s2] */
    TORQUE = RESIDUALS + 2, /* of the gears on the link, mean of the last step [N m] */
    NUMBERS
};

/* With a controller, then: */
enum {
    CONTROLLED = NUMBERS, /* 1 once the controller has run */
    TARGETS,              /* the last two controls [rad] */
    TARGETS_KNOWN = TARGETS + 2,
    SCALE_KNOWN, /* 1 once the observer has an angle of the link */
    SCALE,       /* of the link's angle less the observer's [turns] */
    ESTIMATES,   /* numbers of the sensor from COMMANDED_TORQUE on */
    OBSERVER = ESTIMATES + 11,
    COMPENSATION = OBSERVER + JOINT_OBSERVER_STATE_WORDS,
    CONTROLLED_NUMBERS = COMPENSATION + JOINT_COMPENSATION_STATE_WORDS
};

/* Numbers of the sensor. */
enum {
    MOTOR_ANGLE,
    MOTOR_SPEED,
    LINK_ANGLE,
    LINK_SPEED,
    GAP,
    CONTACT,
    WIND_UP,
    MOTOR_COUNTS,
    OUTPUT_COUNTS,
    MOTOR_TORQUE,
    LINK_TORQUE,
    SENSORS,
    /* With a controller: */
    COMMANDED_TORQUE = SENSORS,
    ESTIMATED_GAP,
    GAP_VALID,
    ESTIMATED_HALF_BACKLASH,
    HALF_BACKLASH_VALID,
    ESTIMATED_CONTACT,
    CONTACT_VALID,
    ESTIMATED_LINK_ANGLE,
    ESTIMATED_LINK_SPEED,
    ESTIMATED_LOAD_TORQUE,
    TRUST,
    CONTROLLED_SENSORS
};

/* Law of an instance, by its key `controller`. */
typedef enum Law { NO_LAW, POSITION, IMPEDANCE, UNKNOWN_LAW } Law;

static const char *const law_names[UNKNOWN_LAW] = {"none", "position", "impedance"};

typedef char estimates_fit[OBSERVER - ESTIMATES == CONTROLLED_SENSORS - SENSORS ? 1 : -1];

typedef struct Instance {
    JointPlant plant;
    JointObserver observer;
    JointCompensation compensation;
    Law law;
    double stiffness, damping;
    JointTablesFacts facts;
    /* 1 if the joint was set to another angle in this step. */
    int was_set;
    /* Words that observer and compensation hold; empty if `holds` is 0. */
    double held[CONTROLLED_NUMBERS - OBSERVER];
    int holds;
    int actuator;
    int dof;
    int periods;
    double h;
    /* State after the present step, until MuJoCo asks for it. */
    double next[CONTROLLED_NUMBERS];
    int has_next;
} Instance;

static void check(JointStatus status, const char *name) {
    if (status != JOINT_STATUS_OK) {
        mju_error("%s: %s: %s", PLUGIN_NAME, name, joint_status_text(status));
    }
}

/* Reason for which a model cannot be stepped, or NULL. */
static const char *unfit(const mjModel *m, int *periods) {
    const double wanted = (double)m->opt.timestep * CONTROL_RATE_HZ, whole = round(wanted);
    if (m->opt.integrator == mjINT_RK4) {
        return "integrator RK4 evaluates the joint at four times within a step, but steps its state once: choose Euler, "
               "implicit or implicitfast";
    }
    if (m->opt.integrator != mjINT_EULER && m->opt.integrator != mjINT_IMPLICIT && m->opt.integrator != mjINT_IMPLICITFAST) {
        return "the joint was not made for this integrator: choose Euler, implicit or implicitfast";
    }
    if (whole < 1.0 || whole > 1e5 || fabs(wanted - whole) > MOST_DEVIATION * whole) {
        return "timestep is not a multiple of the joint's control period: change it, or export the joint with another --rate";
    }
    *periods = (int)whole;
    return NULL;
}

/* The only actuator of an instance; -1 and a reason if there is no usable one. */
static int actuator_of(const mjModel *m, int instance, const char **reason) {
    int found = -1;
    for (int i = 0; i < ACTUATORS(m); i++) {
        if (m->actuator_plugin[i] != instance) {
            continue;
        }
        if (found >= 0) {
            *reason = "two actuators share an instance: give each an instance of its own";
            return -1;
        }
        found = i;
    }
    if (found < 0) {
        *reason = "no actuator uses this instance: name it in an actuator";
    } else if (m->actuator_trntype[found] != mjTRN_JOINT || m->jnt_type[m->actuator_trnid[2 * found]] != mjJNT_HINGE) {
        *reason = "the actuator does not drive a hinge: give it the attribute joint, with a joint of type hinge";
        return -1;
    } else if (m->actuator_gear[6 * OUTPUT(m, found)] != 1.0) {
        *reason = "gear is not 1: the gear is in the plug-in; remove the attribute";
        return -1;
    } else if (m->actuator_forcelimited[found] != 0) {
        *reason = "forcerange would cut the torque of the gears: remove it, and limit the motor's torque by ctrlrange";
        return -1;
    }
    return found;
}

/* Value of a key of an instance; NULL if there is none. */
static const char *config_of(const mjModel *m, int instance, const char *key) {
    const char *const value = mj_getPluginConfig(m, instance, key);
    return value != NULL && value[0] != '\0' ? value : NULL;
}

static Law law_of(const mjModel *m, int instance) {
    const char *const name = config_of(m, instance, "controller");
    int law = NO_LAW;
    while (name != NULL && law < UNKNOWN_LAW && strcmp(name, law_names[law]) != 0) {
        law++;
    }
    return (Law)law;
}

/* Reads a key that is a number from 0 on; 0 without a reason, or with one if it is no such number. */
static double positive_of(const mjModel *m, int instance, const char *key, const char **reason) {
    const char *const text = config_of(m, instance, key);
    char *end = NULL;
    const double value = text != NULL ? strtod(text, &end) : 0.0;
    if (text == NULL || *end != '\0' || !(value >= 0.0 && value < 1e9)) {
        *reason = "controller impedance needs the keys stiffness [N m/rad] and damping [N m s/rad], numbers from 0 on";
        return 0.0;
    }
    return value;
}

static int state_numbers(const mjModel *m, int instance) {
    return law_of(m, instance) == NO_LAW ? NUMBERS : CONTROLLED_NUMBERS;
}

static int sensor_numbers(const mjModel *m, int instance, int sensor) {
    (void)sensor;
    return law_of(m, instance) == NO_LAW ? SENSORS : CONTROLLED_SENSORS;
}

static JointStatus start_controller(Instance *own) {
    const JointStatus status = joint_observer_start(&own->observer, sizeof own->observer, tables, sizeof tables);
    own->holds = 0;
    return status != JOINT_STATUS_OK
               ? status
               : joint_compensation_start(&own->compensation, sizeof own->compensation, tables, sizeof tables);
}

static int init(const mjModel *m, mjData *d, int instance) {
    const char *reason = NULL;
    int periods = 0;
    const int actuator = actuator_of(m, instance, &reason);
    const Law law = law_of(m, instance);
    double stiffness = 0.0, damping = 0.0;
    Instance *own;
    reason = reason != NULL ? reason : unfit(m, &periods);
    if (law == UNKNOWN_LAW && reason == NULL) {
        reason = "the key controller is none of: none, position, impedance";
    }
    if (law == IMPEDANCE && reason == NULL) {
        stiffness = positive_of(m, instance, "stiffness", &reason);
        damping = positive_of(m, instance, "damping", &reason);
    }
    if (reason != NULL) {
        mju_warning("%s: %s", PLUGIN_NAME, reason);
        return -1;
    }
    own = calloc(1, sizeof *own);
    if (own == NULL) {
        mju_warning("%s: no memory", PLUGIN_NAME);
        return -1;
    }
    if (joint_plant_start(&own->plant, sizeof own->plant, tables, sizeof tables) != JOINT_STATUS_OK ||
        joint_tables_facts(tables, sizeof tables, &own->facts) != JOINT_STATUS_OK ||
        start_controller(own) != JOINT_STATUS_OK) {
        mju_warning("%s: the tables in the plug-in are damaged: export it again", PLUGIN_NAME);
        free(own);
        return -1;
    }
    own->law = law;
    own->stiffness = stiffness;
    own->damping = damping;
    own->actuator = actuator;
    own->dof = m->jnt_dofadr[m->actuator_trnid[2 * actuator]];
    own->periods = periods;
    own->h = (double)m->opt.timestep;
    d->plugin_data[instance] = (uintptr_t)own;
    return 0;
}

static void destroy(mjData *d, int instance) {
    free((void *)d->plugin_data[instance]);
    d->plugin_data[instance] = 0;
}

static void reset(const mjModel *m, mjtNum *plugin_state, void *plugin_data, int instance) {
    memset(plugin_state, 0, (size_t)state_numbers(m, instance) * sizeof *plugin_state);
    if (plugin_data != NULL) {
        ((Instance *)plugin_data)->has_next = 0;
    }
}

/* Present motion of the plant. */
typedef struct Motion {
    JointPlantOutputs outputs;
    double carrier_rad;
    double link_rad;
    double link_speed;
    double motor_speed;
} Motion;

static Motion motion_of(const Instance *own) {
    Motion motion;
    float motor = 0.0f, link = 0.0f;
    check(joint_plant_outputs(&own->plant, &motion.outputs), "joint_plant_outputs");
    check(joint_plant_speeds(&own->plant, &motor, &link), "joint_plant_speeds");
    motion.carrier_rad = ((double)motion.outputs.carrier_turns + (double)motion.outputs.carrier_fraction / 4294967296.0) * TURN_RAD;
    motion.link_rad = motion.carrier_rad + (double)motion.outputs.link_offset_rad;
    motion.link_speed = (double)link;
    motion.motor_speed = (double)motor;
    return motion;
}

/* Splits an angle into whole turns and the rest. */
static void set_turns(double turns, int32_t *whole, float *fraction) {
    *whole = (int32_t)turns;
    *fraction = (float)(turns - (double)*whole);
}

/* Copies words of a state from numbers of plugin_state, and back. */
static void words_of(const mjtNum *numbers, uint32_t *words, int count) {
    for (int i = 0; i < count; i++) {
        words[i] = (uint32_t)numbers[i];
    }
}

static void numbers_of(const uint32_t *words, double *numbers, int count) {
    for (int i = 0; i < count; i++) {
        numbers[i] = (double)words[i];
    }
}

/* Turns the whole joint; the teeth keep their deformations. */
static void shift(Instance *own, double angle_rad, double speed) {
    int32_t whole;
    float fraction;
    set_turns(angle_rad / TURN_RAD, &whole, &fraction);
    check(joint_plant_shift(&own->plant, whole, fraction, (float)speed), "joint_plant_shift");
}

/* State of the joint at the start of a step. */
static Motion begin(Instance *own, const mjtNum *state, double angle, double speed) {
    Motion motion;
    own->was_set = 0;
    if (state[STARTED] == 0.0) {
        check(joint_plant_start(&own->plant, sizeof own->plant, tables, sizeof tables), "joint_plant_start");
        shift(own, angle, speed);
        return motion_of(own);
    } else {
        uint32_t words[JOINT_PLANT_STATE_WORDS];
        double error, explained;
        words_of(state, words, JOINT_PLANT_STATE_WORDS);
        check(joint_plant_load(&own->plant, words, JOINT_PLANT_STATE_WORDS), "joint_plant_load");
        motion = motion_of(own);
        error = angle - motion.link_rad;
        explained = own->h * (fabs(speed - motion.link_speed) + fabs(speed)) + SET_RAD;
        if (fabs(error) > explained) {
            /* The angle was set from outside: the whole joint goes there, at the speed that was set with it. */
            shift(own, error, speed - motion.link_speed);
            own->was_set = 1;
            motion = motion_of(own);
        }
        return motion;
    }
}

static double smaller(double first, double second) {
    return first * second <= 0.0 ? 0.0 : fabs(first) < fabs(second) ? first : second;
}

/* Control within its range; one that is no number is replaced. */
static double control_of(const mjModel *m, const mjData *d, int actuator, double replacement) {
    const int control = CONTROL(m, actuator);
    double value = (double)d->ctrl[control];
    if (!isfinite(value)) {
        return replacement;
    }
    if (m->actuator_ctrllimited[LIMITS(control, actuator)] != 0) {
        const mjtNum *const range = m->actuator_ctrlrange + 2 * LIMITS(control, actuator);
        value = value < (double)range[0] ? (double)range[0] : value > (double)range[1] ? (double)range[1] : value;
    }
    /* Beyond it the current loop limits the torque anyway, and turns exceed 32 bits. */
    return value > 1e9 ? 1e9 : value < -1e9 ? -1e9 : value;
}

/* Motion that is wanted at the start of a step. */
typedef struct Target {
    double angle, speed, acceleration;
} Target;

static Target target_of(const Instance *own, const mjtNum *state, double control, double inverse_inertia) {
    const double h = own->h, last = state[TARGETS], before = state[TARGETS + 1];
    const double acceleration = (control - 2.0 * last + before) / (h * h);
    const double most = (double)own->facts.torque_limit_Nm * (double)own->facts.ratio * inverse_inertia;
    Target target = {control, 0.0, 0.0};
    if (state[TARGETS_KNOWN] >= 2.0 && fabs(acceleration) <= most) {
        target.speed = (3.0 * control - 4.0 * last + before) / (2.0 * h);
        target.acceleration = acceleration;
    }
    return target;
}

/* State of observer and compensation at the start of a step. */
static void begin_controller(Instance *own, const mjtNum *state) {
    double *const next = own->next;
    for (int i = NUMBERS; i < OBSERVER; i++) {
        next[i] = (double)state[i];
    }
    if (state[CONTROLLED] == 0.0) {
        check(start_controller(own), "start of the controller");
    } else if (own->holds == 0 || memcmp(own->held, state + OBSERVER, sizeof own->held) != 0) {
        uint32_t observer[JOINT_OBSERVER_STATE_WORDS], compensation[JOINT_COMPENSATION_STATE_WORDS];
        words_of(state + OBSERVER, observer, JOINT_OBSERVER_STATE_WORDS);
        words_of(state + COMPENSATION, compensation, JOINT_COMPENSATION_STATE_WORDS);
        check(joint_observer_load_state(&own->observer, observer, JOINT_OBSERVER_STATE_WORDS), "joint_observer_load_state");
        check(joint_compensation_load_state(&own->compensation, compensation, JOINT_COMPENSATION_STATE_WORDS),
              "joint_compensation_load_state");
    }
    if (own->was_set != 0) {
        /* To the encoders this is a jump: start anew, with the parameters that were estimated. */
        uint8_t memory[JOINT_MEMORY_BYTES];
        check(joint_observer_save(&own->observer, memory, sizeof memory), "joint_observer_save");
        check(start_controller(own), "start of the controller");
        /* A memory of a joint that was never moved may be refused; the start has the designed parameters. */
        (void)!joint_observer_load(&own->observer, memory, sizeof memory);
        next[SCALE_KNOWN] = 0.0;
        next[TARGETS_KNOWN] = 0.0;
    }
    own->holds = 0;
}

/* Torque of the motor in a control period, `time` after the start of the step. */
static float controlled(Instance *own, const Target *target, double time, JointTorque *torque) {
    double *const next = own->next;
    const double angle = target->angle + time * (target->speed + 0.5 * time * target->acceleration);
    const double speed = target->speed + time * target->acceleration;
    double turns;
    JointSamples samples;
    check(joint_plant_samples(&own->plant, &samples), "joint_plant_samples");
    check(joint_observer_step(&own->observer, &samples), "joint_observer_step");
    if (next[SCALE_KNOWN] == 0.0) {
        JointEstimates found;
        check(joint_observer_estimates(&own->observer, &found), "joint_observer_estimates");
        if (found.source != JOINT_SOURCE_NOTHING) {
            const double difference =
                motion_of(own).link_rad / TURN_RAD - ((double)found.link.turns + (double)found.link.fraction_turns);
            /* An output encoder tells the angle within a turn; without one, the angle at the start is taken as known. */
            next[SCALE] = own->facts.has_output_encoder != 0 ? round(difference) : difference;
            next[SCALE_KNOWN] = 1.0;
        }
    }
    turns = angle / TURN_RAD - next[SCALE];
    if (own->law == IMPEDANCE) {
        JointImpedance spring;
        set_turns(turns, &spring.turns, &spring.fraction_turns);
        spring.speed_rad_per_s = (float)speed;
        spring.torque_Nm = 0.0f;
        spring.stiffness_Nm_per_rad = (float)own->stiffness;
        spring.damping_Nm_s_per_rad = (float)own->damping;
        check(joint_compensation_yield(&own->compensation, &own->observer, &spring, torque), "joint_compensation_yield");
    } else {
        JointMotion now;
        set_turns(turns, &now.turns, &now.fraction_turns);
        now.speed_rad_per_s = (float)speed;
        now.acceleration_rad_per_s2 = (float)target->acceleration;
        check(joint_compensation_follow(&own->compensation, &own->observer, &now, NULL, torque), "joint_compensation_follow");
    }
    return torque->motor_torque_Nm;
}

static double side_of(JointContact contact) {
    return contact == JOINT_CONTACT_DRIVE_SIDE ? 1.0 : contact == JOINT_CONTACT_BACK_SIDE ? -1.0 : 0.0;
}

/* Keeps state and estimates of the controller at the end of a step. */
static void end_controller(Instance *own, double control, const JointTorque *torque) {
    double *const next = own->next, *const values = own->next + ESTIMATES - SENSORS;
    uint32_t observer[JOINT_OBSERVER_STATE_WORDS], compensation[JOINT_COMPENSATION_STATE_WORDS];
    JointEstimates found;
    next[CONTROLLED] = 1.0;
    next[TARGETS + 1] = next[TARGETS];
    next[TARGETS] = control;
    next[TARGETS_KNOWN] = next[TARGETS_KNOWN] < 2.0 ? next[TARGETS_KNOWN] + 1.0 : 2.0;
    check(joint_observer_estimates(&own->observer, &found), "joint_observer_estimates");
    values[COMMANDED_TORQUE] = (double)torque->motor_torque_Nm;
    values[ESTIMATED_GAP] = (double)found.gap_m.value;
    values[GAP_VALID] = (double)found.gap_m.valid;
    values[ESTIMATED_HALF_BACKLASH] = (double)found.half_backlash_m.value;
    values[HALF_BACKLASH_VALID] = (double)found.half_backlash_m.valid;
    values[ESTIMATED_CONTACT] = side_of(found.contact);
    values[CONTACT_VALID] = (double)found.contact_valid;
    values[ESTIMATED_LINK_ANGLE] = ((double)found.link.turns + (double)found.link.fraction_turns + next[SCALE]) * TURN_RAD;
    values[ESTIMATED_LINK_SPEED] = (double)found.link.speed_rad_per_s;
    values[ESTIMATED_LOAD_TORQUE] = (double)found.load_torque_Nm.value;
    values[TRUST] = (double)torque->trust;
    check(joint_observer_save_state(&own->observer, observer, JOINT_OBSERVER_STATE_WORDS), "joint_observer_save_state");
    check(joint_compensation_save_state(&own->compensation, compensation, JOINT_COMPENSATION_STATE_WORDS),
          "joint_compensation_save_state");
    numbers_of(observer, next + OBSERVER, JOINT_OBSERVER_STATE_WORDS);
    numbers_of(compensation, next + COMPENSATION, JOINT_COMPENSATION_STATE_WORDS);
    memcpy(own->held, next + OBSERVER, sizeof own->held);
    own->holds = 1;
}

static void actuate(const mjModel *m, mjData *d, Instance *own, const mjtNum *state) {
    const int output = OUTPUT(m, own->actuator);
    const double speed = (double)d->actuator_velocity[output], h = own->h;
    const double angle = (double)d->actuator_length[output] - 0.5 * h * speed;
    const Motion start = begin(own, state, angle, speed);
    const double angle_error = angle - start.link_rad, speed_error = speed - start.link_speed;
    const int was_started = state[STARTED] != 0.0;
    /* Like MuJoCo's, a torque that is no number is zero; a target that is none is the one before, or the present angle. */
    const double replacement =
        own->law == NO_LAW ? 0.0 : state[TARGETS_KNOWN] > 0.0 ? (double)state[TARGETS] : start.link_rad;
    const double control = control_of(m, d, own->actuator, replacement);
    Target target = {0.0, 0.0, 0.0};
    JointTorque controlled_torque;
    double inverse_inertia, smooth, residual, acceleration, sum = 0.0, mean;
    uint32_t words[JOINT_PLANT_STATE_WORDS];
    mjtNum *right, *solved;
    mj_markStack(d);
    right = mj_stackAllocNum(d, 2 * (size_t)m->nv);
    solved = mj_stackAllocNum(d, 2 * (size_t)m->nv);
    for (int i = 0; i < m->nv; i++) {
        right[i] = i == own->dof ? 1.0 : 0.0;
        right[m->nv + i] = d->qfrc_passive[i] + d->qfrc_applied[i] - d->qfrc_bias[i];
    }
    mj_solveM(m, d, solved, right, 2);
    inverse_inertia = (double)solved[own->dof];
    smooth = (double)solved[m->nv + own->dof];
    mj_freeStack(d);

    memcpy(&own->next[RESIDUALS], &state[RESIDUALS], 2 * sizeof own->next[0]);
    if (was_started) {
        own->next[RESIDUALS + 1] = own->next[RESIDUALS];
        own->next[RESIDUALS] = (speed - state[SPEED]) / h - state[PREDICTED];
    }
    residual = smaller(own->next[RESIDUALS], own->next[RESIDUALS + 1]);
    acceleration = smooth + residual + (1.5 * speed_error + angle_error / h) / h;
    if (own->law != NO_LAW) {
        begin_controller(own, state);
        target = target_of(own, own->next, control, inverse_inertia);
    }
    for (int period = 0; period < own->periods; period++) {
        float torque = 0.0f;
        const float command =
            own->law == NO_LAW ? (float)control : controlled(own, &target, period * h / own->periods, &controlled_torque);
        check(joint_plant_step_with_link(&own->plant, command, (float)inverse_inertia,
                                         (float)acceleration, &torque),
              "joint_plant_step_with_link");
        sum += (double)torque;
    }
    mean = sum / own->periods;
    d->actuator_force[output] = mean;

    check(joint_plant_save(&own->plant, words, JOINT_PLANT_STATE_WORDS), "joint_plant_save");
    numbers_of(words, own->next, JOINT_PLANT_STATE_WORDS);
    own->next[STARTED] = 1.0;
    own->next[SPEED] = speed;
    own->next[PREDICTED] = mean * inverse_inertia + smooth;
    own->next[TORQUE] = mean;
    if (own->law != NO_LAW) {
        end_controller(own, control, &controlled_torque);
    }
    own->has_next = 1;
}

/* Side of the sun's meshes: 1 on the drive side, -1 on the back side, 0 in the gap. */
static double contact_of(const JointPlantOutputs *outputs) {
    double side = 0.0;
    for (uint32_t planet = 0; planet < outputs->planets; planet++) {
        const JointContact contact = outputs->sun_contacts[planet];
        side = contact == JOINT_CONTACT_DRIVE_SIDE ? 1.0 : contact == JOINT_CONTACT_BACK_SIDE && side == 0.0 ? -1.0 : side;
    }
    return side;
}

static void sense(const mjModel *m, mjData *d, Instance *own, const mjtNum *state, int instance) {
    const int output = OUTPUT(m, own->actuator);
    const double speed = (double)d->actuator_velocity[output];
    const Motion motion = begin(own, state, (double)d->actuator_length[output] - 0.5 * own->h * speed, speed);
    JointSamples samples;
    check(joint_plant_samples(&own->plant, &samples), "joint_plant_samples");
    for (int i = 0; i < m->nsensor; i++) {
        mjtNum *const values = d->sensordata + m->sensor_adr[i];
        if (m->sensor_type[i] != mjSENS_PLUGIN || m->sensor_plugin[i] != instance) {
            continue;
        }
        values[MOTOR_ANGLE] = RATIO * motion.carrier_rad + (double)motion.outputs.motor_offset_rad;
        values[MOTOR_SPEED] = motion.motor_speed;
        values[LINK_ANGLE] = motion.link_rad;
        values[LINK_SPEED] = motion.link_speed;
        values[GAP] = (double)motion.outputs.gap_m;
        values[CONTACT] = contact_of(&motion.outputs);
        values[WIND_UP] = (double)motion.outputs.wind_up_m;
        values[MOTOR_COUNTS] = (double)samples.motor.counts;
        values[OUTPUT_COUNTS] = (double)samples.output.counts;
        values[MOTOR_TORQUE] = (double)motion.outputs.air_gap_torque_Nm;
        values[LINK_TORQUE] = state[TORQUE];
        for (int number = SENSORS; own->law != NO_LAW && number < CONTROLLED_SENSORS; number++) {
            values[number] = state[ESTIMATES + number - SENSORS];
        }
    }
}

static void compute(const mjModel *m, mjData *d, int instance, int capability) {
    Instance *const own = (Instance *)d->plugin_data[instance];
    const mjtNum *const state = d->plugin_state + m->plugin_stateadr[instance];
    /* The model's options may have been changed since the start. */
    const char *const reason = unfit(m, &own->periods);
    if (reason != NULL) {
        mju_error("%s: %s", PLUGIN_NAME, reason);
    }
    own->h = (double)m->opt.timestep;
    if (capability == mjPLUGIN_ACTUATOR) {
        actuate(m, d, own, state);
    } else {
        sense(m, d, own, state, instance);
    }
}

static void advance(const mjModel *m, mjData *d, int instance) {
    Instance *const own = (Instance *)d->plugin_data[instance];
    mjtNum *const state = d->plugin_state + m->plugin_stateadr[instance];
    if (own->has_next != 0) {
        const int numbers = own->law == NO_LAW ? NUMBERS : CONTROLLED_NUMBERS;
        for (int i = 0; i < numbers; i++) {
            state[i] = own->next[i];
        }
        own->has_next = 0;
    }
}

__attribute__((constructor)) static void register_plugin(void) {
    static const char *keys[] = {"controller", "stiffness", "damping"};
    mjpPlugin plugin;
    mjp_defaultPlugin(&plugin);
    plugin.nattribute = sizeof keys / sizeof *keys;
    plugin.attributes = keys;
    plugin.name = PLUGIN_NAME;
    plugin.capabilityflags = mjPLUGIN_ACTUATOR | mjPLUGIN_SENSOR;
    plugin.needstage = mjSTAGE_VEL;
    plugin.nstate = state_numbers;
    plugin.nsensordata = sensor_numbers;
    plugin.init = init;
    plugin.destroy = destroy;
    plugin.reset = reset;
    plugin.compute = compute;
    plugin.advance = advance;
    mjp_registerPlugin(&plugin);
}
