/*
 * A planetary joint with backlash: plant, observer, compensation, width probe and wiring check for C and C++.
 *
 * This header is written by cbindgen from bindings/c/src and compared with it by a test; change it there.
 * MIT OR Apache-2.0.
 *
 * Rules for every function:
 *
 * - It returns a JointStatus; joint_status_name and joint_status_text explain it. Unless it is JOINT_STATUS_OK, nothing
 *   was changed.
 * - A pointer may be NULL only where its function allows it, and must be aligned for its type: otherwise it is rejected.
 *   The memory that a function writes to belongs to the caller and is no part of an object.
 * - Objects lie in storage that the caller owns: a variable of a type of this header, in RAM. Start an object in its final
 *   place: a moved or copied object is rejected. There is nothing to free. The content of an object is private.
 * - Tables are constants that `joint tables` writes: an array of uint64_t. It must not move or change while an object that
 *   was started from it is used. Starting reads all of it, to check its digest; steps do not.
 * - Objects hold all state. Two contexts may call at once if they use different objects. Only one context at a time may
 *   use an object: read estimates in the interrupt that steps the observer, or with that interrupt masked.
 * - Calls take bounded time, never wait and never allocate. Starting, saving and loading take longest: call them outside
 *   of the control period.
 * - Functions need only memcpy and memset of the C library; for a Cortex-M the compiler names them __aeabi_memcpy,
 *   __aeabi_memmove, __aeabi_memset, __aeabi_memclr, also with 4 or 8 at the end. Arithmetic that the processor lacks comes
 *   from libgcc. Without a C library, use test/board/memory.c of the archive.
 * - Header and library belong together: an object is not started for a header of another version
 *   (JOINT_STATUS_OTHER_HEADER). Include it as <lostmotion/joint.h>; <lostmotion/joint.hpp> is a C++ interface over it.
 * - A call sets the floating-point unit to its standard mode (rounding, flush-to-zero, default NaN) and restores the
 *   caller's mode: results are bit-identical on every machine, however the caller was compiled. A library for Cortex-M is
 *   for the hard-float ABI.
 * - Units are SI and end the name: _Nm, _rad, _m, _s, _Hz. Unbounded angles are whole turns and a fraction of a turn.
 *   Torques and angles are positive in the direction in which both encoders count up.
 *
 * Most stack of a call below its caller, on a Cortex-M [B]. Vendors' start-up code often gives 1 kB in all:
 *     joint_plant_start 1536
 *     joint_observer_load 1408
 *     joint_observer_step, joint_observer_save 1280
 *     joint_plant_step_with_link 1152
 *     joint_wiring_verdicts 1024
 *     joint_observer_start, joint_observer_start_without_maps, joint_compensation_follow 896
 *     joint_compensation_yield 768
 *     joint_plant_step 704
 *     joint_wiring_step, joint_plant_load 576
 *     joint_wiring_start 480
 *     joint_plant_save 448
 *     joint_plant_outputs, joint_compensation_start, joint_observer_load_state 416
 *     joint_tables_facts, joint_plant_shift, joint_observer_save_state 256
 *     joint_observer_estimates, joint_probe_start, joint_compensation_load_state 208
 *     joint_plant_samples, joint_compensation_save_state 160
 *     joint_plant_digest 96
 *     joint_probe_step 40
 *     joint_plant_speeds 24
 *
 * One control period:
 *
 *     joint_observer_step(&observer, &samples);
 *     joint_compensation_follow(&compensation, &observer, &now, &ahead, &torque);
 *     current_A = torque.motor_torque_Nm / torque_constant_Nm_per_A;
 */

#ifndef LOSTMOTION_JOINT_H
#define LOSTMOTION_JOINT_H

#if defined(__cplusplus) && __cplusplus >= 201703L
#define JOINT_MUST_USE [[nodiscard]]
#elif defined(__GNUC__)
#define JOINT_MUST_USE __attribute__((warn_unused_result))
#else
#define JOINT_MUST_USE
#endif

#include <stddef.h>
#include <stdint.h>

// Version of this header: major.
#define JOINT_VERSION_MAJOR 0

// Version of this header: minor.
#define JOINT_VERSION_MINOR 1

// Version of this header: patch.
#define JOINT_VERSION_PATCH 0

// Version of the interface between caller and library. It grows when a struct, an enumeration or the meaning of a
// field changes; sizes are checked in addition.
#define JOINT_ABI_VERSION 1

// Bytes of a joint's name, including the terminating zero.
#define JOINT_NAME_BYTES 32

// Version of the tables that this library reads.
#define JOINT_TABLES_VERSION 5

// In `notices`: the torque exceeded twice the motor's limit and was replaced by zero.
#define JOINT_NOTICE_TORQUE_UNKNOWN 1

// In `notices`: the period was too short or too long, or time went backwards.
#define JOINT_NOTICE_OUT_OF_TIME 2

// In `notices`: the motor's counts were further away than the motor can turn, and were rejected.
#define JOINT_NOTICE_MOTOR_IMPLAUSIBLE 4

// In `notices`: the motor's counts were implausible repeatedly.
#define JOINT_NOTICE_MOTOR_JUMPED 8

// In `notices`, until the observer is restarted: the motor moved against its torque. Torque or motor encoder has the
// wrong sign.
#define JOINT_NOTICE_TORQUE_REVERSED 16

// 64-bit words of a wiring check.
#define JOINT_WIRING_WORDS 72

// Number of items of the wiring.
#define JOINT_WIRING_ITEMS 13

// 64-bit words of an observer.
#define JOINT_OBSERVER_WORDS 275

// Bytes of an observer's saved memory.
#define JOINT_MEMORY_BYTES 544

// 32-bit words of an observer's saved state.
#define JOINT_OBSERVER_STATE_WORDS 621

// 64-bit words of a compensation.
#define JOINT_COMPENSATION_WORDS 65

// 32-bit words of a compensation's saved state.
#define JOINT_COMPENSATION_STATE_WORDS 143

// 64-bit words of a width probe.
#define JOINT_PROBE_WORDS 16

// 64-bit words of a plant.
#define JOINT_PLANT_WORDS 80

// Maximum number of planets of a plant.
#define JOINT_MOST_PLANETS 5

// 32-bit words of a plant's saved state.
#define JOINT_PLANT_STATE_WORDS 39

// Result of every function. Unless it is `JOINT_STATUS_OK`, nothing was changed.
enum JointStatus
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Done.
  JOINT_STATUS_OK = 0,
  // A pointer is NULL.
  JOINT_STATUS_NULL_POINTER = 1,
  // A pointer is not aligned for its type.
  JOINT_STATUS_MISALIGNED = 2,
  // A size differs from the one that the header states.
  JOINT_STATUS_WRONG_SIZE = 3,
  // The object was not started, was moved, or is of another kind.
  JOINT_STATUS_NOT_STARTED = 4,
  // A number is infinite or not a number.
  JOINT_STATUS_NOT_FINITE = 5,
  // The data are no tables.
  JOINT_STATUS_NOT_TABLES = 6,
  // The tables have another version than this library.
  JOINT_STATUS_WRONG_TABLES_VERSION = 7,
  // The digest of the tables does not match: they are damaged.
  JOINT_STATUS_DAMAGED_TABLES = 8,
  // The tables were made without this part.
  JOINT_STATUS_MISSING_TABLES = 9,
  // Two objects, or an object and a state, are of different tables.
  JOINT_STATUS_OTHER_TABLES = 10,
  // The data are no memory of an observer.
  JOINT_STATUS_NOT_A_MEMORY = 11,
  // The memory has another version of the observer.
  JOINT_STATUS_WRONG_MEMORY_VERSION = 12,
  // The digest of the memory does not match: it is damaged.
  JOINT_STATUS_DAMAGED_MEMORY = 13,
  // The memory belongs to another joint or to other encoders.
  JOINT_STATUS_OTHER_JOINT = 14,
  // The memory holds a number that no joint of this design can have.
  JOINT_STATUS_MEMORY_OUT_OF_RANGE = 15,
  // A fraction of a turn is more than a turn.
  JOINT_STATUS_FRACTION_OUT_OF_RANGE = 16,
  // The caller was compiled with a header of another version.
  JOINT_STATUS_OTHER_HEADER = 17,
  // The observer has been stepped; a memory is loaded before the first step.
  JOINT_STATUS_ALREADY_STEPPED = 18,
  // The data are no state of an object of this kind.
  JOINT_STATUS_NOT_A_STATE = 19,
  // The state has the layout of another version of the library.
  JOINT_STATUS_WRONG_STATE_VERSION = 20,
  // The digest of the state does not match: it is damaged.
  JOINT_STATUS_DAMAGED_STATE = 21,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum JointStatus JointStatus;
#else
typedef uint32_t JointStatus;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Progress of a wiring check.
enum JointWiringProgress
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Go on: command the torque, and call again in the next period.
  JOINT_WIRING_PROGRESS_RUNNING = 0,
  // The check is over: read the verdicts.
  JOINT_WIRING_PROGRESS_DONE = 1,
  // The joint moved before any torque was given: let it come to rest.
  JOINT_WIRING_PROGRESS_NOT_AT_REST = 2,
  // The joint moved further than allowed: look for another drive. The verdicts hold as far as they go.
  JOINT_WIRING_PROGRESS_TOO_FAR = 3,
  // The check took too long: check the times of the samples. The verdicts hold as far as they go.
  JOINT_WIRING_PROGRESS_TOO_LONG = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum JointWiringProgress JointWiringProgress;
#else
typedef uint32_t JointWiringProgress;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Verdict on an item of the wiring.
enum JointVerdict
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The samples do not show it.
  JOINT_VERDICT_NOT_SEEN = 0,
  // Equal to the tables.
  JOINT_VERDICT_RIGHT = 1,
  // Different from the tables; `found` is the measured value.
  JOINT_VERDICT_WRONG = 2,
  // This item or another suspect is wrong, and the samples do not tell which; `found` is the value if it is this
  // one.
  JOINT_VERDICT_SUSPECT = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum JointVerdict JointVerdict;
#else
typedef uint32_t JointVerdict;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Encoders on which the estimates are based.
enum JointSource
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // No encoder: nothing is valid, and values without measurements are held.
  JOINT_SOURCE_NOTHING = 0,
  // Motor encoder only: the load cannot be observed while the gap is open.
  JOINT_SOURCE_MOTOR_ONLY = 1,
  // Motor and output encoder.
  JOINT_SOURCE_BOTH = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum JointSource JointSource;
#else
typedef uint32_t JointSource;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Reason for which an encoder is not used.
enum JointFault
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // No fault: the encoder is used.
  JOINT_FAULT_NONE = 0,
  // No such encoder in the design.
  JOINT_FAULT_ABSENT = 1,
  // No new readings.
  JOINT_FAULT_SILENT = 2,
  // Readings are late repeatedly.
  JOINT_FAULT_LATE = 3,
  // Counts stand still while the joint turns.
  JOINT_FAULT_FROZEN = 4,
  // Counts of the motor encoder jumped further than the motor can turn.
  JOINT_FAULT_JUMPED = 5,
  // Counts of the output encoder imply an impossible gap coordinate.
  JOINT_FAULT_OUT_OF_RANGE = 6,
  // No reading of the output encoder yet: the compensation gives no torque before the first one.
  JOINT_FAULT_UNHEARD = 7,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum JointFault JointFault;
#else
typedef uint32_t JointFault;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Flank that carries the force.
enum JointContact
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // No flank: the teeth are in the gap, or the contact is unknown.
  JOINT_CONTACT_SEPARATED = 0,
  // Drive side: the motor drives the load forwards; deflection, force and torque are positive.
  JOINT_CONTACT_DRIVE_SIDE = 1,
  // Back side: deflection, force and torque are negative.
  JOINT_CONTACT_BACK_SIDE = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum JointContact JointContact;
#else
typedef uint32_t JointContact;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Stage of the compensation.
enum JointStage
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // A flank carries the demand; or friction holds the link at its set-point, and the motor waits in the middle of
  // the gap.
  JOINT_STAGE_TOUCHING = 0,
  // The motor moves through the gap towards a flank.
  JOINT_STAGE_CROSSING = 1,
  // The motor approaches a flank at a small speed.
  JOINT_STAGE_LANDING = 2,
  // Control without compensation: the gap is not observable.
  JOINT_STAGE_PLAIN = 3,
  // No torque: the position of the motor is unknown.
  JOINT_STAGE_OFF = 4,
  // No torque until observer and compensation are restarted: the motor moved against its torque, so torque or motor
  // encoder has the wrong sign.
  JOINT_STAGE_REVERSED = 5,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum JointStage JointStage;
#else
typedef uint32_t JointStage;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Progress of a probe.
enum JointProgress
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Go on: command the torque, and call again in the next period.
  JOINT_PROGRESS_RUNNING = 0,
  // The half-backlash is valid.
  JOINT_PROGRESS_DONE = 1,
  // The motor was turning when the probe began: let it come to rest.
  JOINT_PROGRESS_NOT_AT_REST = 2,
  // The load presses the teeth with more torque than the probe may use: remove the load.
  JOINT_PROGRESS_LOADED = 3,
  // The motor did not come to rest, or moved further than the teeth allow: hold the load.
  JOINT_PROGRESS_NOT_HELD = 4,
  // The motor hardly moved: friction exceeds the probe's torque, or the joint is blocked.
  JOINT_PROGRESS_STUCK = 5,
  // The first and the last pass differ: something moved.
  JOINT_PROGRESS_UNSTEADY = 6,
  // Samples were missing or wrong, or torque or motor encoder has the wrong sign.
  JOINT_PROGRESS_BAD_SAMPLES = 7,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum JointProgress JointProgress;
#else
typedef uint32_t JointProgress;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Properties that tables were made for.
typedef struct JointTablesFacts {
  // Digest of the tables: objects started from tables with one digest belong together.
  uint64_t digest;
  // Version of the layout.
  uint32_t version;
  // Control rate: the step functions are called at this rate.
  uint32_t control_rate_Hz;
  // Tick rate of the samples' clock.
  uint32_t clock_rate_Hz;
  // Control period.
  float period_s;
  // Bandwidth that the compensation was designed for.
  float bandwidth_rad_per_s;
  // Time from `now` to `ahead` in joint_compensation_follow.
  float lead_s;
  // Motor turns per turn of the link.
  float ratio;
  // Limit of the compensation's torque command.
  float torque_limit_Nm;
  // Planets of the plant; 1 for an equivalent gear, 0 if the tables hold no plant.
  uint32_t planets;
  // 1 if the observer uses an output encoder, else 0.
  uint32_t has_output_encoder;
  // 1 if the tables hold a width probe, else 0.
  uint32_t has_probe;
  // Name of the joint, terminated by zero.
  char name[JOINT_NAME_BYTES];
} JointTablesFacts;

// Storage of a wiring check. Its content is the library's own.
typedef struct JointWiring {
  uint64_t storage[JOINT_WIRING_WORDS];
} JointWiring;

// Reading of an encoder.
typedef struct JointReading {
  // Raw counts of the encoder, wrapping as stated in the joint file.
  uint32_t counts;
  // Time of the reading, in ticks of the samples' clock; wraps at 2^32.
  uint32_t time_ticks;
} JointReading;

// Measurements of one control period.
typedef struct JointSamples {
  // Time of the samples, in ticks of the clock that the tables were made for (joint_tables_facts); wraps at 2^32.
  uint32_t time_ticks;
  // Encoder on the motor.
  struct JointReading motor;
  // Encoder on the link.
  struct JointReading output;
  // 0 if there is no output encoder, or no reading of it in this period; `output` is then ignored. Otherwise
  // nonzero.
  uint32_t has_output;
  // Torque at the motor's shaft that was commanded last, after every limit: current times torque constant.
  float motor_torque_Nm;
} JointSamples;

// Outputs of one control period of a wiring check.
typedef struct JointWiringStep {
  // Torque to command next at the motor's shaft, never larger than allowed; zero once the check has ended.
  float motor_torque_Nm;
  // Progress.
  JointWiringProgress progress;
} JointWiringStep;

// Verdicts on all items, indexed by JointWiringItem.
typedef struct JointWiringVerdicts {
  // 1 if every item that these tables allow to be judged was seen and is right, else 0.
  uint32_t all_right;
  // Number of items that are wrong or suspect.
  uint32_t bad;
  // Verdicts.
  JointVerdict verdicts[JOINT_WIRING_ITEMS];
  // Measured values for wrong and suspect items; else 0.
  float found[JOINT_WIRING_ITEMS];
} JointWiringVerdicts;

// Storage of an observer. Its content is the library's own.
typedef struct JointObserver {
  uint64_t storage[JOINT_OBSERVER_WORDS];
} JointObserver;

// Value with its variance and validity. Value and variance are always finite.
typedef struct JointEstimate {
  // Estimate, in the unit of the field's name.
  float value;
  // Variance, in the square of the unit.
  float variance;
  // 1 if the value may be used, 0 if it is only a guess.
  uint32_t valid;
} JointEstimate;

// Angle and speed of a shaft.
typedef struct JointShaft {
  // Whole turns since the start of the observer, wrapping.
  int32_t turns;
  // Remaining fraction of a turn, from 0 to 1.
  float fraction_turns;
  // Speed.
  float speed_rad_per_s;
} JointShaft;

// All estimates of one control period. A positive gap coordinate, force or torque drives the load forwards.
typedef struct JointEstimates {
  // Encoders on which the estimates are based.
  JointSource source;
  // Reason for which the motor encoder is not used.
  JointFault motor_fault;
  // Reason for which the output encoder is not used.
  JointFault output_fault;
  // Defects of the samples: a sum of JOINT_NOTICE_ bits.
  uint32_t notices;
  // Gap coordinate along the line of action: from -2 b to 2 b while every mesh is free.
  struct JointEstimate gap_m;
  // Rate of the gap coordinate.
  float gap_rate_m_per_s;
  // Contact from the mesh force alone: later, but independent of the half-backlash.
  JointContact contact_by_force;
  // Contact from force and gap coordinate, for use in a controller.
  JointContact contact;
  // 1 if `contact` may be used, else 0.
  uint32_t contact_valid;
  // 1 if contact has held long enough, with enough force, for parameters to be estimated; else 0.
  uint32_t settled;
  // Torque transmitted by the meshes, at the carrier.
  struct JointEstimate mesh_torque_Nm;
  // Torque that brakes the link: friction, weight, contact.
  struct JointEstimate load_torque_Nm;
  // Half-backlash b of each mesh.
  struct JointEstimate half_backlash_m;
  // Lead of the motor encoder over the output encoder with every tooth centred, relative to the start; at the
  // output.
  struct JointEstimate encoder_offset_rad;
  // Torsional compliance from sun to link, at the output.
  struct JointEstimate compliance_rad_per_Nm;
  // Delay of output readings not covered by their time stamps, minus the corresponding delay of the motor encoder.
  struct JointEstimate skew_s;
  // Torque that the motor loses in either direction.
  struct JointEstimate torque_bias_Nm;
  // Dry friction of the motor.
  struct JointEstimate motor_friction_Nm;
  // Inertia of link and carrier over the joint file's value.
  struct JointEstimate link_inertia_ratio;
  // Motor shaft, corrected for estimated encoder errors.
  struct JointShaft motor;
  // Link, corrected for estimated encoder errors. With the motor encoder alone, computed from it.
  struct JointShaft link;
} JointEstimates;

// Storage of a compensation. Its content is the library's own.
typedef struct JointCompensation {
  uint64_t storage[JOINT_COMPENSATION_WORDS];
} JointCompensation;

// Motion of the link at one time, on the scale of the observer's link shaft.
typedef struct JointMotion {
  // Whole turns.
  int32_t turns;
  // Remaining fraction of a turn, from -1 to 1.
  float fraction_turns;
  // Speed.
  float speed_rad_per_s;
  // Acceleration.
  float acceleration_rad_per_s2;
} JointMotion;

// Output of the compensation.
typedef struct JointTorque {
  // Torque for the motor's shaft, finite and within the limit; divided by the torque constant it is the current to
  // command.
  float motor_torque_Nm;
  // Torque that the teeth must transmit after a crossing that began now.
  float demand_Nm;
  // Estimated load on the link without dry friction.
  float load_Nm;
  // Estimated dry friction of the link.
  float friction_Nm;
  // Share of the compensation in the torque, 0 to 1; the rest is control without compensation.
  float trust;
  // Stage of the compensation.
  JointStage stage;
  // Flank that carries, or towards which the motor moves.
  JointContact flank;
  // 1 if the law requires more torque than the motor has, or brakes early for lack of torque; else 0.
  uint32_t short_of_torque;
  // 1 while control without compensation is active because the loop hunted; else 0.
  uint32_t stepped_back;
} JointTorque;

// Spring and damper about a moving point, on the scale of the observer's link shaft.
typedef struct JointImpedance {
  // Whole turns of the point.
  int32_t turns;
  // Remaining fraction of a turn, from -1 to 1.
  float fraction_turns;
  // Speed of the point.
  float speed_rad_per_s;
  // Torque at the link, on top of spring and damper.
  float torque_Nm;
  // Stiffness at the link.
  float stiffness_Nm_per_rad;
  // Damping at the link.
  float damping_Nm_s_per_rad;
} JointImpedance;

// Storage of a width probe. Its content is the library's own.
typedef struct JointProbe {
  uint64_t storage[JOINT_PROBE_WORDS];
} JointProbe;

// Output of a probe.
typedef struct JointProbed {
  // Torque to command next at the motor's shaft; zero once the probe has ended.
  float motor_torque_Nm;
  // Progress.
  JointProgress progress;
  // Half-backlash of each mesh; valid when done.
  struct JointEstimate half_backlash_m;
} JointProbed;

// Storage of a plant. Its content is the library's own.
typedef struct JointPlant {
  uint64_t storage[JOINT_PLANT_WORDS];
} JointPlant;

// True motion of a plant, which no sensor measures: for evaluating a controller.
typedef struct JointPlantOutputs {
  // Whole turns of the rigid-body carrier angle.
  int32_t carrier_turns;
  // Fraction of the turn of that angle, in 2^-32 turns.
  uint32_t carrier_fraction;
  // Rate of the rigid-body carrier angle.
  float carrier_speed_rad_per_s;
  // Motor angle less ratio times the rigid-body carrier angle.
  float motor_offset_rad;
  // Link angle less the rigid-body carrier angle.
  float link_offset_rad;
  // Gap coordinate along the line of action.
  float gap_m;
  // Wind-up between carrier and link along the line of action.
  float wind_up_m;
  // Torque in the motor's air gap.
  float air_gap_torque_Nm;
  // Torque on the sun, friction and cogging included.
  float drive_torque_Nm;
  // Torque that brakes the link: friction, weight, disturbance.
  float load_torque_Nm;
  // Number of planets; the arrays below have this many entries in use.
  uint32_t planets;
  // Deflections of the sun's meshes, planet by planet.
  float sun_deflections_m[JOINT_MOST_PLANETS];
  // Deflections of the ring's meshes, planet by planet.
  float ring_deflections_m[JOINT_MOST_PLANETS];
  // Contacts of the sun's meshes.
  JointContact sun_contacts[JOINT_MOST_PLANETS];
  // Contacts of the ring's meshes.
  JointContact ring_contacts[JOINT_MOST_PLANETS];
} JointPlantOutputs;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Version of the library: major in bits 16 to 23, minor in bits 8 to 15, patch in bits 0 to 7.
uint32_t joint_version(void);

// The name of a status, such as "JOINT_STATUS_OK"; never NULL.
const char *joint_status_name(uint32_t status);

// Meaning of a status and its remedy, in one sentence; never NULL.
const char *joint_status_text(uint32_t status);

// Reads the properties of tables, as joint_tables_facts; `abi` is JOINT_ABI.
JOINT_MUST_USE
JointStatus joint_tables_facts_checked(const uint64_t *tables,
                                       size_t tables_bytes,
                                       struct JointTablesFacts *facts,
                                       uint32_t abi);

// Starts a wiring check, as joint_wiring_start; `abi` is JOINT_ABI.
JOINT_MUST_USE
JointStatus joint_wiring_start_checked(struct JointWiring *wiring,
                                       size_t bytes,
                                       const uint64_t *tables,
                                       size_t tables_bytes,
                                       uint32_t abi);

// One control period of a wiring check, instead of the observer's and the compensation's steps. With an allowed torque
// of zero, or with another torque in force than the commanded one, any motion in the samples is judged.
JOINT_MUST_USE
JointStatus joint_wiring_step(struct JointWiring *wiring,
                              const struct JointSamples *samples,
                              float allowed_torque_Nm,
                              struct JointWiringStep *step);

// Copies the verdicts on the motion so far, outside of the control period.
JOINT_MUST_USE
JointStatus joint_wiring_verdicts(const struct JointWiring *wiring,
                                  struct JointWiringVerdicts *verdicts);

// Name of an item of the wiring, such as "output_direction"; never NULL.
const char *joint_wiring_item_name(uint32_t item);

// Error and remedy for an item of the wiring, in one sentence; never NULL.
const char *joint_wiring_item_text(uint32_t item);

// Starts an observer, as joint_observer_start; `abi` is JOINT_ABI.
JOINT_MUST_USE
JointStatus joint_observer_start_checked(struct JointObserver *observer,
                                         size_t bytes,
                                         const uint64_t *tables,
                                         size_t tables_bytes,
                                         uint32_t abi);

// Starts an observer, as joint_observer_start_without_maps; `abi` is JOINT_ABI.
JOINT_MUST_USE
JointStatus joint_observer_start_without_maps_checked(struct JointObserver *observer,
                                                      size_t bytes,
                                                      const uint64_t *tables,
                                                      size_t tables_bytes,
                                                      uint32_t abi);

// One control period: processes the samples.
JOINT_MUST_USE
JointStatus joint_observer_step(struct JointObserver *observer,
                                const struct JointSamples *samples);

// Copies the estimates of the last period.
JOINT_MUST_USE
JointStatus joint_observer_estimates(const struct JointObserver *observer,
                                     struct JointEstimates *estimates);

// Saves the estimated parameters, outside of the control period. `bytes` is JOINT_MEMORY_BYTES.
JOINT_MUST_USE
JointStatus joint_observer_save(const struct JointObserver *observer,
                                uint8_t *memory,
                                size_t bytes);

// Loads saved parameters, outside of the control period and before the first step. `bytes` is JOINT_MEMORY_BYTES.
JOINT_MUST_USE
JointStatus joint_observer_load(struct JointObserver *observer,
                                const uint8_t *memory,
                                size_t bytes);

// Copies the whole state of an observer, without addresses. `words` is JOINT_OBSERVER_STATE_WORDS.
JOINT_MUST_USE
JointStatus joint_observer_save_state(const struct JointObserver *observer,
                                      uint32_t *state,
                                      size_t words);

// Continues from a saved state of an observer of the same tables, in this process or another, before or after steps.
// `words` is JOINT_OBSERVER_STATE_WORDS. Equal states continue with equal bits.
JOINT_MUST_USE
JointStatus joint_observer_load_state(struct JointObserver *observer,
                                      const uint32_t *state,
                                      size_t words);

// Starts a compensation, as joint_compensation_start; `abi` is JOINT_ABI.
JOINT_MUST_USE
JointStatus joint_compensation_start_checked(struct JointCompensation *compensation,
                                             size_t bytes,
                                             const uint64_t *tables,
                                             size_t tables_bytes,
                                             uint32_t abi);

// One control period of position control, after the observer's step: follows a motion. `ahead` is the motion `lead_s`
// (joint_tables_facts) after `now`, or NULL if it is unknown.
JOINT_MUST_USE
JointStatus joint_compensation_follow(struct JointCompensation *compensation,
                                      const struct JointObserver *observer,
                                      const struct JointMotion *now,
                                      const struct JointMotion *ahead,
                                      struct JointTorque *torque);

// One control period of impedance control, after the observer's step: acts as a spring and damper at the link.
JOINT_MUST_USE
JointStatus joint_compensation_yield(struct JointCompensation *compensation,
                                     const struct JointObserver *observer,
                                     const struct JointImpedance *impedance,
                                     struct JointTorque *torque);

// Copies the whole state of a compensation, without addresses. `words` is JOINT_COMPENSATION_STATE_WORDS.
JOINT_MUST_USE
JointStatus joint_compensation_save_state(const struct JointCompensation *compensation,
                                          uint32_t *state,
                                          size_t words);

// Continues from a saved state of a compensation of the same tables, in this process or another. `words` is
// JOINT_COMPENSATION_STATE_WORDS. Equal states continue with equal bits.
JOINT_MUST_USE
JointStatus joint_compensation_load_state(struct JointCompensation *compensation,
                                          const uint32_t *state,
                                          size_t words);

// Starts a width probe, as joint_probe_start; `abi` is JOINT_ABI.
JOINT_MUST_USE
JointStatus joint_probe_start_checked(struct JointProbe *probe,
                                      size_t bytes,
                                      const uint64_t *tables,
                                      size_t tables_bytes,
                                      uint32_t abi);

// One control period of a probe, after the observer's step and instead of the compensation's.
JOINT_MUST_USE
JointStatus joint_probe_step(struct JointProbe *probe,
                             const struct JointObserver *observer,
                             struct JointProbed *probed);

// Starts a plant, as joint_plant_start; `abi` is JOINT_ABI.
JOINT_MUST_USE
JointStatus joint_plant_start_checked(struct JointPlant *plant,
                                      size_t bytes,
                                      const uint64_t *tables,
                                      size_t tables_bytes,
                                      uint32_t abi);

// Advances by one control period under a torque command for the motor and a torque that brakes the link.
JOINT_MUST_USE
JointStatus joint_plant_step(struct JointPlant *plant,
                             float motor_torque_Nm,
                             float load_torque_Nm);

// Advances by one control period with a link that another simulator moves. Its acceleration is the torque of the gears
// times `link_inverse_inertia_per_kg_m2`, plus `link_acceleration_rad_per_s2`. `link_torque_Nm` receives the mean torque of
// the gears on the link. Inertia, weight and friction of the link are the other simulator's; the tables' have no effect.
JOINT_MUST_USE
JointStatus joint_plant_step_with_link(struct JointPlant *plant,
                                       float motor_torque_Nm,
                                       float link_inverse_inertia_per_kg_m2,
                                       float link_acceleration_rad_per_s2,
                                       float *link_torque_Nm);

// Turns the whole plant by an angle at the link, whole turns and a fraction, and changes the link's speed; the teeth keep
// their deformations.
JOINT_MUST_USE
JointStatus joint_plant_shift(struct JointPlant *plant,
                              int32_t turns,
                              float fraction_turns,
                              float speed_rad_per_s);

// Copies the state of a plant, without addresses. `words` is JOINT_PLANT_STATE_WORDS.
JOINT_MUST_USE JointStatus joint_plant_save(const struct JointPlant *plant, uint32_t *state, size_t words);

// Continues from a saved state of a plant of the same tables, in this process or another. `words` is
// JOINT_PLANT_STATE_WORDS. Equal states continue with equal bits.
JOINT_MUST_USE JointStatus joint_plant_load(struct JointPlant *plant, const uint32_t *state, size_t words);

// Present encoder readings, and the torque that was commanded last.
JOINT_MUST_USE JointStatus joint_plant_samples(const struct JointPlant *plant, struct JointSamples *samples);

// Present motion.
JOINT_MUST_USE
JointStatus joint_plant_outputs(const struct JointPlant *plant,
                                struct JointPlantOutputs *motion);

// Present speeds of motor and link.
JOINT_MUST_USE
JointStatus joint_plant_speeds(const struct JointPlant *plant,
                               float *motor_rad_per_s,
                               float *link_rad_per_s);

// Digest of every bit of the gears' state; equal digests mean equal runs so far.
JOINT_MUST_USE JointStatus joint_plant_digest(const struct JointPlant *plant, uint64_t *digest);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

/* Version of what crosses the boundary, and sizes of all structs as this compiler has them. The library refuses to start
   an object for a header whose sum differs: it would write beyond the caller's structs. */
#define JOINT_FOLD(sum, type) (31u * (sum) + (uint32_t)sizeof(type))
#define JOINT_ABI JOINT_FOLD( \
  JOINT_FOLD( \
  JOINT_FOLD( \
  JOINT_FOLD( \
  JOINT_FOLD( \
  JOINT_FOLD( \
  JOINT_FOLD( \
  JOINT_FOLD( \
  JOINT_FOLD( \
  JOINT_FOLD( \
  JOINT_FOLD( \
  JOINT_FOLD( \
  JOINT_FOLD( \
  JOINT_FOLD( \
  JOINT_FOLD( \
  JOINT_FOLD( \
  JOINT_FOLD( \
  JOINT_FOLD( \
  (uint32_t)JOINT_ABI_VERSION, JointTablesFacts), JointReading), JointSamples), JointEstimate), JointShaft), JointEstimates), JointMotion), JointImpedance), JointTorque), JointProbed), JointPlantOutputs), JointWiringStep), JointWiringVerdicts), JointObserver), JointCompensation), JointProbe), JointPlant), JointWiring)

/* Looks at tables: whether they are sound, and what they were made for. `facts` may be NULL. */
JOINT_MUST_USE static inline JointStatus joint_tables_facts(const uint64_t *tables, size_t tables_bytes,
    JointTablesFacts *facts) {
  return joint_tables_facts_checked(tables, tables_bytes, facts, JOINT_ABI);
}

/* Starts an observer with maps of the encoders' errors. `bytes` is sizeof(JointObserver). The tables must stay as they are
   for as long as it is used. */
JOINT_MUST_USE static inline JointStatus joint_observer_start(JointObserver *object, size_t bytes,
    const uint64_t *tables, size_t tables_bytes) {
  return joint_observer_start_checked(object, bytes, tables, tables_bytes, JOINT_ABI);
}

/* Starts an observer without maps of the encoders' errors: for ideal encoders, or where flash is short. */
JOINT_MUST_USE static inline JointStatus joint_observer_start_without_maps(JointObserver *object, size_t bytes,
    const uint64_t *tables, size_t tables_bytes) {
  return joint_observer_start_without_maps_checked(object, bytes, tables, tables_bytes, JOINT_ABI);
}

/* Starts a compensation. `bytes` is sizeof(JointCompensation). The tables must stay as they are for as long as it is used. */
JOINT_MUST_USE static inline JointStatus joint_compensation_start(JointCompensation *object, size_t bytes,
    const uint64_t *tables, size_t tables_bytes) {
  return joint_compensation_start_checked(object, bytes, tables, tables_bytes, JOINT_ABI);
}

/* Starts a width probe. `bytes` is sizeof(JointProbe). The load is to be held, and the motor at rest. */
JOINT_MUST_USE static inline JointStatus joint_probe_start(JointProbe *object, size_t bytes,
    const uint64_t *tables, size_t tables_bytes) {
  return joint_probe_start_checked(object, bytes, tables, tables_bytes, JOINT_ABI);
}

/* Starts a plant, at rest. `bytes` is sizeof(JointPlant). The tables must stay as they are for as long as it is used. */
JOINT_MUST_USE static inline JointStatus joint_plant_start(JointPlant *object, size_t bytes,
    const uint64_t *tables, size_t tables_bytes) {
  return joint_plant_start_checked(object, bytes, tables, tables_bytes, JOINT_ABI);
}

/* Starts a wiring check. `bytes` is sizeof(JointWiring). The joint is to be at rest, and free to turn by a few degrees at
   the output. */
JOINT_MUST_USE static inline JointStatus joint_wiring_start(JointWiring *object, size_t bytes,
    const uint64_t *tables, size_t tables_bytes) {
  return joint_wiring_start_checked(object, bytes, tables, tables_bytes, JOINT_ABI);
}

/* Size and alignment of the storage that the caller owns. */
#if defined(__cplusplus)
#define JOINT_ASSERT(holds, name) static_assert(holds, #name)
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define JOINT_ASSERT(holds, name) _Static_assert(holds, #name)
#else
#define JOINT_ASSERT(holds, name) typedef char name[(holds) ? 1 : -1]
#endif
JOINT_ASSERT(sizeof(JointObserver) == 8 * JOINT_OBSERVER_WORDS, joint_observer_size);
JOINT_ASSERT(sizeof(JointCompensation) == 8 * JOINT_COMPENSATION_WORDS, joint_compensation_size);
JOINT_ASSERT(sizeof(JointProbe) == 8 * JOINT_PROBE_WORDS, joint_probe_size);
JOINT_ASSERT(sizeof(JointPlant) == 8 * JOINT_PLANT_WORDS, joint_plant_size);
JOINT_ASSERT(sizeof(JointWiring) == 8 * JOINT_WIRING_WORDS, joint_wiring_size);
#if defined(__cplusplus)
JOINT_ASSERT(alignof(JointObserver) == 8, joint_observer_alignment);
JOINT_ASSERT(alignof(JointCompensation) == 8, joint_compensation_alignment);
JOINT_ASSERT(alignof(JointProbe) == 8, joint_probe_alignment);
JOINT_ASSERT(alignof(JointPlant) == 8, joint_plant_alignment);
JOINT_ASSERT(alignof(JointWiring) == 8, joint_wiring_alignment);
#else
struct joint_observer_aligned { char first; JointObserver object; };
JOINT_ASSERT(offsetof(struct joint_observer_aligned, object) == 8, joint_observer_alignment);
struct joint_compensation_aligned { char first; JointCompensation object; };
JOINT_ASSERT(offsetof(struct joint_compensation_aligned, object) == 8, joint_compensation_alignment);
struct joint_probe_aligned { char first; JointProbe object; };
JOINT_ASSERT(offsetof(struct joint_probe_aligned, object) == 8, joint_probe_alignment);
struct joint_plant_aligned { char first; JointPlant object; };
JOINT_ASSERT(offsetof(struct joint_plant_aligned, object) == 8, joint_plant_alignment);
struct joint_wiring_aligned { char first; JointWiring object; };
JOINT_ASSERT(offsetof(struct joint_wiring_aligned, object) == 8, joint_wiring_alignment);
#endif
#undef JOINT_ASSERT

#endif /* LOSTMOTION_JOINT_H */
