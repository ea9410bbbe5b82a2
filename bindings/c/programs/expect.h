/* Expected statuses of calls. */
#ifndef EXPECT_H
#define EXPECT_H

#include <lostmotion/joint.h>
#include "say.h"

/* Returns whether a status is the expected one; if not, prints the call and its status. */
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
