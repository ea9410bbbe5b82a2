/*
 * Checks that the library works on this machine: runs the closed loop of run.h and compares its digest. EXPECTED_DIGEST is
 * the digest of the Rust core, computed when the archive was built.
 */
#include "run.h"
#include "say.h"
#include "tables_of_test.h"

#ifndef PERIODS
#define PERIODS 20000u
#endif

static Run run;

static int failed(const char *what, JointStatus status) {
    say(what);
    say(": ");
    say(joint_status_name(status));
    say(", ");
    say(joint_status_text(status));
    say("\n");
    return 1;
}

int main(void) {
    JointStatus status = run_start(&run, tables_of_test, sizeof tables_of_test);
    if (status != JOINT_STATUS_OK) {
        return failed("start", status);
    }
    while (run.period < PERIODS) {
        status = run_period(&run);
        if (status != JOINT_STATUS_OK) {
            return failed("period", status);
        }
    }
    say("digest ");
    say_hexadecimal(run.digest);
    say("\n");
#ifdef EXPECTED_DIGEST
    if (run.digest != EXPECTED_DIGEST) {
        say("another digest was expected: this library does not compute what the core does\n");
        return 1;
    }
    say("as expected\n");
#endif
    say("end of measurement\n");
    return 0;
}
