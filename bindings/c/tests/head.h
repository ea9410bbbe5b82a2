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
