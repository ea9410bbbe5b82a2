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
 * - Calls take bounded time, wait for nothing, allocate nothing, and call nothing of the C library. Starting, saving and
 *   loading take longest: do them outside of the control period.
 * - The floating-point unit's mode (rounding, flush-to-zero, default NaN) is set to the standard one for the length of a
 *   call, and the caller's comes back: results are the same in every bit on every machine, whatever the caller was
 *   compiled with. A library for Cortex-M is for the hard-float ABI.
 * - Units are SI and end the name: _Nm, _rad, _m, _s, _Hz. Angles without bound are whole turns and a fraction of a turn.
 *   Torques and angles are positive in the direction in which both encoders count up.
 *
 * One control period:
 *
 *     joint_observer_step(&observer, &samples);
 *     joint_compensation_follow(&compensation, &observer, &now, &ahead, &torque);
 *     current_A = torque.motor_torque_Nm / torque_constant_Nm_per_A;
 */
