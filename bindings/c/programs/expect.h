/* What a call of the library is expected to answer. */
#ifndef EXPECT_H
#define EXPECT_H

#include <lostmotion/joint.h>
#include "say.h"

/* Whether a status is the expected one; if not, says which call it was and what it answered. */
static inline int is(JointStatus found, JointStatus expected, const char *what) {
    if (found != expected) {
        say(what);
        say(": ");
        say(joint_status_name(found));
        say("\n");
        return 0;
    }
    return 1;
}

#endif
