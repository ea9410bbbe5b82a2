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
