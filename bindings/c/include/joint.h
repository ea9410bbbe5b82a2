/*
 * Forwards to lostmotion/joint.h: the name joint.h may collide with a header of the caller.
 * MIT OR Apache-2.0.
 */
#ifndef LOSTMOTION_OLD_JOINT_H
#define LOSTMOTION_OLD_JOINT_H
#if defined(__GNUC__) || defined(_MSC_VER)
#pragma message("joint.h has moved: include <lostmotion/joint.h>")
#endif
#include "lostmotion/joint.h"
#endif
