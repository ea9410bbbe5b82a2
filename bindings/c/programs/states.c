/*
 * Saves the states of a plant, an observer and a compensation, and loads them into objects of the same tables and of the
 * tables in the file of the first argument, which is of another joint or rate.
 */
#include "expect.h"
#include "say.h"
#include "tables_of_test.h"

#include <stdio.h>

/* Objects started from one set of tables. */
typedef struct {
    JointPlant plant;
    JointObserver observer;
    JointCompensation compensation;
} Objects;

static Objects one, same, other;
static uint64_t other_tables[4096];
static uint32_t plant_words[JOINT_PLANT_STATE_WORDS], observer_words[JOINT_OBSERVER_STATE_WORDS],
    compensation_words[JOINT_COMPENSATION_STATE_WORDS];

static int start(Objects *objects, const uint64_t *tables, size_t bytes) {
    return is(joint_plant_start(&objects->plant, sizeof objects->plant, tables, bytes), JOINT_STATUS_OK, "plant") &&
           is(joint_observer_start(&objects->observer, sizeof objects->observer, tables, bytes), JOINT_STATUS_OK, "observer") &&
           is(joint_compensation_start(&objects->compensation, sizeof objects->compensation, tables, bytes), JOINT_STATUS_OK,
              "compensation");
}

static int loads(Objects *into, JointStatus expected) {
    return is(joint_plant_load(&into->plant, plant_words, JOINT_PLANT_STATE_WORDS), expected, "load plant") &&
           is(joint_observer_load_state(&into->observer, observer_words, JOINT_OBSERVER_STATE_WORDS), expected,
              "load observer") &&
           is(joint_compensation_load_state(&into->compensation, compensation_words, JOINT_COMPENSATION_STATE_WORDS), expected,
              "load compensation");
}

int main(int count, char **arguments) {
    FILE *file = count > 1 ? fopen(arguments[1], "rb") : NULL;
    size_t bytes = file != NULL ? fread(other_tables, 1, sizeof other_tables, file) : 0;
    uint64_t before, after;
    int period;
    if (file != NULL) {
        fclose(file);
    }
    if (!start(&one, tables_of_test, sizeof tables_of_test) || !start(&same, tables_of_test, sizeof tables_of_test) ||
        !start(&other, other_tables, bytes)) {
        return 1;
    }
    for (period = 0; period < 1000; period++) {
        if (!is(joint_plant_step(&one.plant, 0.1f, 0.0f), JOINT_STATUS_OK, "step")) {
            return 1;
        }
    }
    if (!is(joint_plant_save(&one.plant, plant_words, JOINT_PLANT_STATE_WORDS), JOINT_STATUS_OK, "save plant") ||
        !is(joint_observer_save_state(&one.observer, observer_words, JOINT_OBSERVER_STATE_WORDS), JOINT_STATUS_OK,
            "save observer") ||
        !is(joint_compensation_save_state(&one.compensation, compensation_words, JOINT_COMPENSATION_STATE_WORDS),
            JOINT_STATUS_OK, "save compensation") ||
        !is(joint_plant_digest(&other.plant, &before), JOINT_STATUS_OK, "digest") ||
        !loads(&other, JOINT_STATUS_OTHER_TABLES) ||
        !is(joint_plant_digest(&other.plant, &after), JOINT_STATUS_OK, "digest")) {
        return 1;
    }
    say(before == after ? "refused states changed nothing\n" : "a refused state changed the plant\n");
    if (!loads(&same, JOINT_STATUS_OK) || !is(joint_plant_digest(&one.plant, &before), JOINT_STATUS_OK, "digest") ||
        !is(joint_plant_digest(&same.plant, &after), JOINT_STATUS_OK, "digest")) {
        return 1;
    }
    say(before == after ? "a loaded state is equal\n" : "a loaded state differs\n");
    return 0;
}
