/*
 * A planetary joint with backlash: plant, observer, compensation, width probe and wiring check for C and C++.
 *
 * This header is written by cbindgen from bindings/c/src and compared with it by a test; change it there.
 * MIT OR Apache-2.0.
 *
 * What holds of every function:
 *
 * - It returns a JointStatus; joint_status_name and joint_status_text say what one means. Unless it is
 *   JOINT_STATUS_OK nothing was changed.
 * - A pointer is NULL only where its function says that it may be. It is aligned for its type; one that is not is
 *   refused. What a function writes to is the caller's own, and no part of an object.
 * - Objects lie in storage that the caller owns: a variable of the type that is named here, in RAM. Start one where it
 *   stays: one that was moved or copied is refused. There is nothing to free. Do not look into it.
 * - Tables are constants that `joint tables` writes: an array of uint64_t, which stays where it is and as it is for as long
 *   as an object that was started from it is used. Starting reads all of it, to check its digest; steps do not.
 * - Nothing is kept between calls but in objects. Two contexts may be in here at once, each with objects of its own. An
 *   object is for one context at a time: read estimates in the interrupt that steps the observer, or with it masked.
 * - Calls take bounded time, wait for nothing and allocate nothing. Starting, saving and loading take longest: do them
 *   outside of the control period.
 * - Of the C library they call memcpy and memset alone; for a Cortex-M the compiler names them __aeabi_memcpy, __aeabi_memmove,
 *   __aeabi_memset, __aeabi_memclr and the same with 4 or 8 at the end. Arithmetic that the processor lacks comes from libgcc.
 *   Without a C library, test/board/memory.c of the archive has them.
 * - Header and library belong together: an object is not started for a header of another version
 *   (JOINT_STATUS_OTHER_HEADER). Include it as <lostmotion/joint.h>; <lostmotion/joint.hpp> is a C++ interface over it.
 * - The floating-point unit's mode (rounding, flush-to-zero, default NaN) is set to the standard one for the length of a
 *   call, and the caller's comes back: results are the same in every bit on every machine, whatever the caller was
 *   compiled with. A library for Cortex-M is for the hard-float ABI.
 * - Units are SI and end the name: _Nm, _rad, _m, _s, _Hz. Angles without bound are whole turns and a fraction of a turn.
 *   Torques and angles are positive in the direction in which both encoders count up.
 *
 * Most stack of a call below its caller, on a Cortex-M [B]. Vendors' start-up code often gives 1 kB in all:
 *     joint_plant_start 1536
 *     joint_observer_load 1408
 *     joint_observer_step, joint_observer_save 1280
 *     joint_wiring_verdicts 1024
 *     joint_observer_start, joint_observer_start_without_maps, joint_compensation_follow 896
 *     joint_compensation_yield 768
 *     joint_plant_step 704
 *     joint_wiring_step 576
 *     joint_wiring_start 480
 *     joint_plant_outputs, joint_compensation_start 416
 *     joint_tables_facts 256
 *     joint_observer_estimates, joint_probe_start 208
 *     joint_plant_samples 160
 *     joint_plant_digest 96
 *     joint_probe_step 40
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

// Version of what crosses the boundary between caller and library. It grows when a struct, an enumeration or the meaning of a
// field changes; sizes are checked beside it.
#define JOINT_ABI_VERSION 1

// Bytes of a joint's name, with the zero at its end.
#define JOINT_NAME_BYTES 32

// Version of tables that this library reads.
#define JOINT_TABLES_VERSION 5

// In `notices`: the torque was more than twice what the motor can give; none was assumed.
#define JOINT_NOTICE_TORQUE_UNKNOWN 1

// In `notices`: the period was too short or too long, or time went backwards.
#define JOINT_NOTICE_OUT_OF_TIME 2

// In `notices`: the motor's counts were further away than it can turn, and were not believed.
#define JOINT_NOTICE_MOTOR_IMPLAUSIBLE 4

// In `notices`: the motor's counts are elsewhere time after time.
#define JOINT_NOTICE_MOTOR_JUMPED 8

// In `notices`, until the observer is started anew: the motor ran against its torque. Torque or motor encoder has the wrong sign.
#define JOINT_NOTICE_TORQUE_REVERSED 16

// 64-bit words of a wiring check.
#define JOINT_WIRING_WORDS 72

// Number of items of the wiring.
#define JOINT_WIRING_ITEMS 13

// 64-bit words of an observer.
#define JOINT_OBSERVER_WORDS 275

// Bytes of what an observer has learnt.
#define JOINT_MEMORY_BYTES 544

// 64-bit words of a compensation.
#define JOINT_COMPENSATION_WORDS 65

// 64-bit words of a width probe.
#define JOINT_PROBE_WORDS 16

// 64-bit words of a plant.
#define JOINT_PLANT_WORDS 80

// Most planets of a plant.
#define JOINT_MOST_PLANETS 5

// What every function returns. Whatever it is, unless it is `JOINT_STATUS_OK` nothing was changed.
enum JointStatus
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Done.
  JOINT_STATUS_OK = 0,
  // A pointer is NULL.
  JOINT_STATUS_NULL_POINTER = 1,
  // A pointer is not aligned for what it points to.
  JOINT_STATUS_MISALIGNED = 2,
  // A size is not the one that the header states.
  JOINT_STATUS_WRONG_SIZE = 3,
  // The object was not started, was moved, or is of another kind.
  JOINT_STATUS_NOT_STARTED = 4,
  // A number is infinite or not a number.
  JOINT_STATUS_NOT_FINITE = 5,
  // These are no tables.
  JOINT_STATUS_NOT_TABLES = 6,
  // The tables are of another version than this library.
  JOINT_STATUS_WRONG_TABLES_VERSION = 7,
  // The digest of the tables does not fit: some of them was lost.
  JOINT_STATUS_DAMAGED_TABLES = 8,
  // These tables were made without this part.
  JOINT_STATUS_MISSING_TABLES = 9,
  // Two objects were started from different tables.
  JOINT_STATUS_OTHER_TABLES = 10,
  // These bytes are no memory of an observer.
  JOINT_STATUS_NOT_A_MEMORY = 11,
  // The memory is of another version of the observer.
  JOINT_STATUS_WRONG_MEMORY_VERSION = 12,
  // The digest of the memory does not fit: some of it was lost.
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
  // The joint moved further than the check may: look for what else drives it. The verdicts hold as far as they go.
  JOINT_WIRING_PROGRESS_TOO_FAR = 3,
  // The check took too long: look at the times of the samples. The verdicts hold as far as they go.
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
  // As in the tables.
  JOINT_VERDICT_RIGHT = 1,
  // Not as in the tables; `found` is what was found instead.
  JOINT_VERDICT_WRONG = 2,
  // This item or another suspect is wrong, and the samples do not tell which; `found` is what it would be.
  JOINT_VERDICT_SUSPECT = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum JointVerdict JointVerdict;
#else
typedef uint32_t JointVerdict;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Which encoders the estimates rest on.
enum JointSource
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // None: nothing is valid, and what is not heard of is held.
  JOINT_SOURCE_NOTHING = 0,
  // The motor encoder alone: the load cannot be seen while the gap is open.
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

// Why an encoder is not used.
enum JointFault
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // It is used.
  JOINT_FAULT_NONE = 0,
  // There is none by design.
  JOINT_FAULT_ABSENT = 1,
  // Nothing fresh is heard of it.
  JOINT_FAULT_SILENT = 2,
  // Its readings are late time after time.
  JOINT_FAULT_LATE = 3,
  // Its counts stand still while the joint turns.
  JOINT_FAULT_FROZEN = 4,
  // The motor's counts are where no motor could go.
  JOINT_FAULT_JUMPED = 5,
  // The output's counts put the gap coordinate where it cannot be.
  JOINT_FAULT_OUT_OF_RANGE = 6,
  // The output encoder has given no reading yet: the compensation gives no torque until it does.
  JOINT_FAULT_UNHEARD = 7,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum JointFault JointFault;
#else
typedef uint32_t JointFault;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Which flank carries the force.
enum JointContact
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // None: the teeth are in the gap, or it is not known where.
  JOINT_CONTACT_SEPARATED = 0,
  // The motor drives the load forwards: deflection, force and torque are positive.
  JOINT_CONTACT_DRIVE_SIDE = 1,
  // The other one: they are negative.
  JOINT_CONTACT_BACK_SIDE = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum JointContact JointContact;
#else
typedef uint32_t JointContact;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What the compensation is about.
enum JointStage
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // A flank carries, or the joint needs none and the motor rests in the middle of the gap.
  JOINT_STAGE_TOUCHING = 0,
  // On the way through the gap.
  JOINT_STAGE_CROSSING = 1,
  // Closing on a flank at a small speed.
  JOINT_STAGE_LANDING = 2,
  // Control without compensation: the gap cannot be seen.
  JOINT_STAGE_PLAIN = 3,
  // No torque: it is not known where the motor is.
  JOINT_STAGE_OFF = 4,
  // No torque until observer and compensation are started anew: the motor ran against its torque, so torque or motor encoder has
  // the wrong sign.
  JOINT_STAGE_REVERSED = 5,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum JointStage JointStage;
#else
typedef uint32_t JointStage;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Where a probe stands.
enum JointProgress
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Go on: command the torque, and call again in the next period.
  JOINT_PROGRESS_RUNNING = 0,
  // The half-backlash is there.
  JOINT_PROGRESS_DONE = 1,
  // The motor was turning when the probe began: let it come to rest.
  JOINT_PROGRESS_NOT_AT_REST = 2,
  // The load pushes the teeth with more than the probe may use: take the load off.
  JOINT_PROGRESS_LOADED = 3,
  // The motor did not come to rest, or went further than the teeth allow: hold the load.
  JOINT_PROGRESS_NOT_HELD = 4,
  // The motor hardly moved: friction is more than the probe may use, or the joint is blocked.
  JOINT_PROGRESS_STUCK = 5,
  // The first and the last pass do not agree: something moved.
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

// What tables were made for.
typedef struct JointTablesFacts {
  // Digest over the tables: objects started from tables of one digest belong together.
  uint64_t digest;
  // Version of the layout.
  uint32_t version;
  // Control periods in a second: call the step functions so often.
  uint32_t control_rate_Hz;
  // Ticks in a second of the clock that samples are timed by.
  uint32_t clock_rate_Hz;
  // A control period.
  float period_s;
  // Bandwidth that the compensation was designed for.
  float bandwidth_rad_per_s;
  // How far ahead of now the second motion of joint_compensation_follow is.
  float lead_s;
  // Motor turns for a turn of the link.
  float ratio;
  // Largest torque that the compensation asks the motor for.
  float torque_limit_Nm;
  // Planets of the plant; 1 for an equivalent gear, 0 if the tables hold no plant.
  uint32_t planets;
  // 1 if the observer uses an output encoder, else 0.
  uint32_t has_output_encoder;
  // 1 if the tables hold a width probe, else 0.
  uint32_t has_probe;
  // Of the joint; ends with a zero.
  char name[JOINT_NAME_BYTES];
} JointTablesFacts;

// Storage of a wiring check. Its content is the library's own.
typedef struct JointWiring {
  uint64_t storage[JOINT_WIRING_WORDS];
} JointWiring;

// One reading of an encoder.
typedef struct JointReading {
  // Raw counts as the encoder gives them, wrapping as the joint file says.
  uint32_t counts;
  // When they were taken, in ticks of the samples' clock; wraps at 2^32.
  uint32_t time_ticks;
} JointReading;

// Everything that is measured in one control period.
typedef struct JointSamples {
  // Now, in ticks of the clock that the tables were made for (joint_tables_facts); wraps at 2^32.
  uint32_t time_ticks;
  // Encoder on the motor.
  struct JointReading motor;
  // Encoder on the link.
  struct JointReading output;
  // 0: there is no output encoder, or it gave nothing in this period; `output` is not looked at. Anything else: there is.
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

// Verdicts on all items, each at the place of its JointWiringItem.
typedef struct JointWiringVerdicts {
  // 1 if every item that these tables let be judged was seen and is right, else 0.
  uint32_t all_right;
  // Items that are wrong or suspect.
  uint32_t bad;
  // Verdicts.
  JointVerdict verdicts[JOINT_WIRING_ITEMS];
  // What was found, where a verdict is wrong or suspect; else 0.
  float found[JOINT_WIRING_ITEMS];
} JointWiringVerdicts;

// Storage of an observer. Its content is the library's own.
typedef struct JointObserver {
  uint64_t storage[JOINT_OBSERVER_WORDS];
} JointObserver;

// A value, how uncertain it is, and whether the observer stands by it. Value and variance are always finite.
typedef struct JointEstimate {
  // Best guess, in the unit that its holder's name ends with.
  float value;
  // Variance, in the square of that unit.
  float variance;
  // 0: the value is only a guess. 1: use it.
  uint32_t valid;
} JointEstimate;

// A shaft: where it is and how fast it turns.
typedef struct JointShaft {
  // Whole turns since the observer began, wrapping.
  int32_t turns;
  // What is left, from 0 to 1.
  float fraction_turns;
  // Speed.
  float speed_rad_per_s;
} JointShaft;

// All estimates of one control period. A positive gap coordinate, force or torque drives the load forwards.
typedef struct JointEstimates {
  // What the rest stands on.
  JointSource source;
  // Why the motor encoder is not used.
  JointFault motor_fault;
  // Why the output encoder is not used.
  JointFault output_fault;
  // What was wrong with the samples: a sum of JOINT_NOTICE_ bits.
  uint32_t notices;
  // Gap coordinate along the line of action: from -2 b to 2 b while every mesh is free.
  struct JointEstimate gap_m;
  // Its rate.
  float gap_rate_m_per_s;
  // Contact by the mesh force alone: late, but needs no width.
  JointContact contact_by_force;
  // Contact by force and gap coordinate: what a controller should use.
  JointContact contact;
  // Whether `contact` may be used.
  uint32_t contact_valid;
  // Contact has held for long enough, with enough force, that the observer learns from it.
  uint32_t settled;
  // Torque that the meshes pass on, at the carrier.
  struct JointEstimate mesh_torque_Nm;
  // Everything that brakes the link: friction, weight, what it touches.
  struct JointEstimate load_torque_Nm;
  // Half-backlash b of each mesh.
  struct JointEstimate half_backlash_m;
  // By how much the motor encoder leads the output encoder with every tooth centred, beyond where they were at the
  // start; at the output.
  struct JointEstimate encoder_offset_rad;
  // Torsional compliance from sun to link, at the output.
  struct JointEstimate compliance_rad_per_Nm;
  // How old output readings are beyond what their time says, less the same of the motor's.
  struct JointEstimate skew_s;
  // Torque that the motor loses whatever its direction.
  struct JointEstimate torque_bias_Nm;
  // Dry friction of the motor.
  struct JointEstimate motor_friction_Nm;
  // Inertia of link and carrier over what the joint file has.
  struct JointEstimate link_inertia_ratio;
  // Motor shaft; encoder errors that were learnt are taken out.
  struct JointShaft motor;
  // Link; likewise. With the motor encoder alone, what that implies.
  struct JointShaft link;
} JointEstimates;

// Storage of a compensation. Its content is the library's own.
typedef struct JointCompensation {
  uint64_t storage[JOINT_COMPENSATION_WORDS];
} JointCompensation;

// Where the link shall be at one moment, on the scale of the observer's link shaft.
typedef struct JointMotion {
  // Whole turns.
  int32_t turns;
  // What is left, from -1 to 1.
  float fraction_turns;
  // Speed.
  float speed_rad_per_s;
  // Acceleration.
  float acceleration_rad_per_s2;
} JointMotion;

// What the compensation answers.
typedef struct JointTorque {
  // Torque for the motor's shaft: over the torque constant, the current to ask for. Finite and within the limit.
  float motor_torque_Nm;
  // Torque that the teeth will have to pass on after a crossing that began now.
  float demand_Nm;
  // What brakes the link besides dry friction, as learnt.
  float load_Nm;
  // Dry friction of the link, as learnt.
  float friction_Nm;
  // Share of the compensation in the torque, the rest being control without: 0 to 1.
  float trust;
  // What it is about.
  JointStage stage;
  // The flank that carries or is being gone to.
  JointContact flank;
  // 1 if the law asks for more torque than the motor has, or brakes early because of that; else 0.
  uint32_t short_of_torque;
  // 1 while control without compensation has taken over because the loop hunted; else 0.
  uint32_t stepped_back;
} JointTorque;

// A spring and damper about a moving point, on the scale of the observer's link shaft.
typedef struct JointImpedance {
  // Whole turns of the point.
  int32_t turns;
  // What is left, from -1 to 1.
  float fraction_turns;
  // Its speed.
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

// What a probe answers.
typedef struct JointProbed {
  // Torque to command next at the motor's shaft; zero once the probe has ended.
  float motor_torque_Nm;
  // Where it stands.
  JointProgress progress;
  // Half-backlash of each mesh; valid when done.
  struct JointEstimate half_backlash_m;
} JointProbed;

// Storage of a plant. Its content is the library's own.
typedef struct JointPlant {
  uint64_t storage[JOINT_PLANT_WORDS];
} JointPlant;

// The motion of a plant, which no sensor sees: for judging what a controller makes of it.
typedef struct JointPlantOutputs {
  // Whole turns of the rigid-body carrier angle.
  int32_t carrier_turns;
  // The rest of it, in 2^-32 turns.
  uint32_t carrier_fraction;
  // Rate of that angle.
  float carrier_speed_rad_per_s;
  // Motor angle less ratio times that angle.
  float motor_offset_rad;
  // Link angle less that angle.
  float link_offset_rad;
  // Gap coordinate along the line of action.
  float gap_m;
  // Wind-up between carrier and link along the line of action.
  float wind_up_m;
  // Torque in the motor's air gap.
  float air_gap_torque_Nm;
  // Torque on the sun, friction and cogging included.
  float drive_torque_Nm;
  // What brakes the link: friction, weight, disturbance.
  float load_torque_Nm;
  // Planets; what follows has so many entries in use.
  uint32_t planets;
  // Deflections of the sun's meshes, planet by planet.
  float sun_deflections_m[JOINT_MOST_PLANETS];
  // Deflections of the ring's.
  float ring_deflections_m[JOINT_MOST_PLANETS];
  // Contacts of the sun's meshes.
  JointContact sun_contacts[JOINT_MOST_PLANETS];
  // Contacts of the ring's.
  JointContact ring_contacts[JOINT_MOST_PLANETS];
} JointPlantOutputs;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Version of the library: major in bits 16 to 23, minor in bits 8 to 15, patch in bits 0 to 7.
uint32_t joint_version(void);

// The name of a status, such as "JOINT_STATUS_OK"; never NULL.
const char *joint_status_name(uint32_t status);

// What a status means and what to do about it, in one sentence; never NULL.
const char *joint_status_text(uint32_t status);

// Looks at tables, as joint_tables_facts; `abi` is JOINT_ABI.
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

// One control period of a wiring check, in place of the observer's and the compensation's steps. With an allowed torque of
// zero, or with another torque than the answer's in force, it judges whatever motion the samples show.
JOINT_MUST_USE
JointStatus joint_wiring_step(struct JointWiring *wiring,
                              const struct JointSamples *samples,
                              float allowed_torque_Nm,
                              struct JointWiringStep *step);

// The verdicts on what a check has seen so far, outside of the control period.
JOINT_MUST_USE
JointStatus joint_wiring_verdicts(const struct JointWiring *wiring,
                                  struct JointWiringVerdicts *verdicts);

// The name of an item of the wiring, such as "output_direction"; never NULL.
const char *joint_wiring_item_name(uint32_t item);

// What is wrong with an item of the wiring, and what to do about it, in one sentence; never NULL.
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

// One control period: takes what was measured.
JOINT_MUST_USE
JointStatus joint_observer_step(struct JointObserver *observer,
                                const struct JointSamples *samples);

// The estimates of the last period.
JOINT_MUST_USE
JointStatus joint_observer_estimates(const struct JointObserver *observer,
                                     struct JointEstimates *estimates);

// Saves what was learnt, outside of the control period. `bytes` is JOINT_MEMORY_BYTES.
JOINT_MUST_USE
JointStatus joint_observer_save(const struct JointObserver *observer,
                                uint8_t *memory,
                                size_t bytes);

// Goes on from what was saved, outside of the control period, before the first step. `bytes` is JOINT_MEMORY_BYTES.
JOINT_MUST_USE
JointStatus joint_observer_load(struct JointObserver *observer,
                                const uint8_t *memory,
                                size_t bytes);

// Starts a compensation, as joint_compensation_start; `abi` is JOINT_ABI.
JOINT_MUST_USE
JointStatus joint_compensation_start_checked(struct JointCompensation *compensation,
                                             size_t bytes,
                                             const uint64_t *tables,
                                             size_t tables_bytes,
                                             uint32_t abi);

// One control period of position control, after the observer's step: follow a motion. `ahead` is the motion by
// `lead_s` (joint_tables_facts) later than `now`, or NULL if that is not known.
JOINT_MUST_USE
JointStatus joint_compensation_follow(struct JointCompensation *compensation,
                                      const struct JointObserver *observer,
                                      const struct JointMotion *now,
                                      const struct JointMotion *ahead,
                                      struct JointTorque *torque);

// One control period of impedance control, after the observer's step: be a spring and damper at the link.
JOINT_MUST_USE
JointStatus joint_compensation_yield(struct JointCompensation *compensation,
                                     const struct JointObserver *observer,
                                     const struct JointImpedance *impedance,
                                     struct JointTorque *torque);

// Starts a width probe, as joint_probe_start; `abi` is JOINT_ABI.
JOINT_MUST_USE
JointStatus joint_probe_start_checked(struct JointProbe *probe,
                                      size_t bytes,
                                      const uint64_t *tables,
                                      size_t tables_bytes,
                                      uint32_t abi);

// One control period of a probe, after the observer's step and in place of the compensation's.
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

// Moves on by one control period under a torque command for the motor and a torque that brakes the link.
JOINT_MUST_USE
JointStatus joint_plant_step(struct JointPlant *plant,
                             float motor_torque_Nm,
                             float load_torque_Nm);

// What the encoders read now, and the torque that was commanded last.
JOINT_MUST_USE JointStatus joint_plant_samples(const struct JointPlant *plant, struct JointSamples *samples);

// The motion now.
JOINT_MUST_USE
JointStatus joint_plant_outputs(const struct JointPlant *plant,
                                struct JointPlantOutputs *motion);

// Digest of every bit of the gears' state: two runs of which it is the same have gone the same way so far.
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
