/*
 * A header and a library of one version work together; a header of another version is rejected, and nothing is written.
 */
#include "expect.h"
#include "say.h"
#include "tables_of_test.h"

#include <string.h>

#define TABLES tables_of_test, sizeof tables_of_test

int main(void) {
    static JointObserver observer, before;
    static JointCompensation compensation;
    static JointProbe probe;
    static JointPlant plant;
    static JointWiring wiring;
    JointTablesFacts facts;
    JointStatus status = joint_observer_start(&observer, sizeof observer, TABLES);
    say(joint_status_name(status));
    say("\n");
    if (status != JOINT_STATUS_OK) {
        return 0;
    }
    if (joint_version() != ((uint32_t)JOINT_VERSION_MAJOR << 16 | JOINT_VERSION_MINOR << 8 | JOINT_VERSION_PATCH)) {
        say("the library is of another version\n");
        return 1;
    }
    memcpy(&before, &observer, sizeof before);
    if (!is(joint_observer_start_checked(&observer, sizeof observer, TABLES, JOINT_ABI + 1u), JOINT_STATUS_OTHER_HEADER, "observer") ||
        !is(joint_observer_start_without_maps_checked(&observer, sizeof observer, TABLES, 0), JOINT_STATUS_OTHER_HEADER, "plain") ||
        !is(joint_compensation_start_checked(&compensation, sizeof compensation, TABLES, 0), JOINT_STATUS_OTHER_HEADER,
            "compensation") ||
        !is(joint_probe_start_checked(&probe, sizeof probe, TABLES, 0), JOINT_STATUS_OTHER_HEADER, "probe") ||
        !is(joint_plant_start_checked(&plant, sizeof plant, TABLES, 0), JOINT_STATUS_OTHER_HEADER, "plant") ||
        !is(joint_wiring_start_checked(&wiring, sizeof wiring, TABLES, 0), JOINT_STATUS_OTHER_HEADER, "wiring") ||
        !is(joint_tables_facts_checked(TABLES, &facts, 0), JOINT_STATUS_OTHER_HEADER, "facts")) {
        return 1;
    }
    say(memcmp(&before, &observer, sizeof before) == 0 ? "nothing was written\n" : "something was written\n");
    return 0;
}
