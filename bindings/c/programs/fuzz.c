/*
 * Fuzz test: random sequences of calls with wrong pointers, sizes, tables, numbers and order. Every buffer ends at a
 * protected page. A wrong call must return an error and change nothing; a right call must return JOINT_STATUS_OK.
 *
 *     fuzz SEQUENCES SEED
 */
#define _DEFAULT_SOURCE 1

#include <lostmotion/joint.h>
#include "say.h"
#include "tables_of_test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { BUFFERS = 22, CALLS = 12 };

/* Argument of a call: place, size, and content before the call. */
typedef struct Buffer {
    unsigned char *at, *before;
    size_t bytes;
} Buffer;

static Buffer buffers[BUFFERS];
static unsigned used;
static uint64_t state;
static uint64_t made, refused;
static int is_wrong;
static uint64_t damaged_tables[sizeof tables_of_test / sizeof(uint64_t)];

static uint32_t chance(uint32_t below) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (uint32_t)(state >> 32) % below;
}

/* Returns a buffer that ends where a protected page begins. */
static void *guarded(size_t bytes) {
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    const size_t pages = (bytes + page - 1u) / page;
    unsigned char *memory =
        (unsigned char *)mmap(NULL, (pages + 1u) * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    Buffer *buffer = &buffers[used];
    if (memory == (unsigned char *)MAP_FAILED || used == BUFFERS || mprotect(memory + pages * page, page, PROT_NONE) != 0) {
        say("no room\n");
        end(1);
    }
    used++;
    buffer->at = memory + pages * page - bytes;
    buffer->bytes = bytes;
    buffer->before = (unsigned char *)malloc(bytes);
    return buffer->at;
}

/* Returns a good pointer or, one time in eight, a wrong one: NULL, misaligned, or an object of another kind. */
static void *pointer(void *good, void *other) {
    switch (chance(24)) {
    case 0:
        is_wrong = 1;
        return NULL;
    case 1:
        is_wrong = 1;
        return (unsigned char *)good + 1 + chance(3);
    case 2:
        if (other != NULL) {
            is_wrong = 1;
            return other;
        }
        return good;
    default:
        return good;
    }
}

static size_t size(size_t good) {
    switch (chance(16)) {
    case 0:
        is_wrong = 1;
        return good - 1u;
    case 1:
        is_wrong = 1;
        return good + 8u;
    case 2:
        is_wrong = 1;
        return 0;
    default:
        return good;
    }
}

static float number(void) {
    switch (chance(40)) {
    case 0:
        is_wrong = 1;
        return NAN;
    case 1:
        is_wrong = 1;
        return INFINITY;
    case 2:
        is_wrong = 1;
        return -INFINITY;
    case 3:
        return 1e-42f;
    case 4:
        return -3e38f;
    case 5:
        return 3e38f;
    default:
        return ((float)chance(2000) - 1000.0f) * 0.003f;
    }
}

int main(int count, char **arguments) {
    const unsigned long sequences = count > 1 ? strtoul(arguments[1], NULL, 10) : 1000ul;
    JointObserver *observers[2], *copy;
    JointCompensation *compensation;
    JointProbe *probe;
    JointPlant *plant;
    JointSamples *samples;
    JointEstimates *estimates;
    JointMotion *now, *ahead;
    JointImpedance *spring;
    JointTorque *torque;
    JointProbed *probed;
    JointPlantOutputs *outputs;
    JointTablesFacts *facts;
    uint64_t *tables, *damaged, *digest;
    unsigned char *memory;
    uint32_t *state_words, *observer_words, *compensation_words;
    float *speeds;
    unsigned long sequence;
    state = (count > 2 ? strtoull(arguments[2], NULL, 10) : 1u) * 0x9e3779b97f4a7c15ull + 1u;
    observers[0] = (JointObserver *)guarded(sizeof(JointObserver));
    observers[1] = (JointObserver *)guarded(sizeof(JointObserver));
    copy = (JointObserver *)guarded(sizeof(JointObserver));
    compensation = (JointCompensation *)guarded(sizeof(JointCompensation));
    probe = (JointProbe *)guarded(sizeof(JointProbe));
    plant = (JointPlant *)guarded(sizeof(JointPlant));
    samples = (JointSamples *)guarded(sizeof(JointSamples));
    estimates = (JointEstimates *)guarded(sizeof(JointEstimates));
    now = (JointMotion *)guarded(sizeof(JointMotion));
    ahead = (JointMotion *)guarded(sizeof(JointMotion));
    spring = (JointImpedance *)guarded(sizeof(JointImpedance));
    torque = (JointTorque *)guarded(sizeof(JointTorque));
    probed = (JointProbed *)guarded(sizeof(JointProbed));
    outputs = (JointPlantOutputs *)guarded(sizeof(JointPlantOutputs));
    facts = (JointTablesFacts *)guarded(sizeof(JointTablesFacts));
    digest = (uint64_t *)guarded(sizeof(uint64_t));
    memory = (unsigned char *)guarded(JOINT_MEMORY_BYTES);
    state_words = (uint32_t *)guarded(JOINT_PLANT_STATE_WORDS * sizeof(uint32_t));
    observer_words = (uint32_t *)guarded(JOINT_OBSERVER_STATE_WORDS * sizeof(uint32_t));
    compensation_words = (uint32_t *)guarded(JOINT_COMPENSATION_STATE_WORDS * sizeof(uint32_t));
    speeds = (float *)guarded(2 * sizeof(float));
    tables = (uint64_t *)guarded(sizeof tables_of_test);
    memcpy(tables, tables_of_test, sizeof tables_of_test);
    damaged = damaged_tables;
    for (sequence = 0; sequence < sequences; sequence++) {
        /* Objects started in this sequence: observers, compensation, probe, plant. */
        int started[5] = {0, 0, 0, 0, 0}, stepped[2] = {0, 0};
        int saved = 0, call;
        unsigned index;
        for (index = 0; index + 1u < used; index++) {
            memset(buffers[index].at, (int)chance(256), buffers[index].bytes);
        }
        for (call = 0; call < CALLS; call++) {
            const unsigned which = chance(2);
            JointObserver *const observer = observers[which];
            const uint64_t *from = tables;
            JointStatus status;
            uint32_t kind = chance(29);
            is_wrong = 0;
            /* Most of the first calls start objects. */
            if (call < 5 && chance(4) != 0) {
                kind = (uint32_t)call;
            }
            if (chance(16) == 0) {
                memcpy(damaged, tables, sizeof tables_of_test);
                damaged[chance((uint32_t)(sizeof tables_of_test / sizeof *damaged))] ^= 1ull << chance(64);
                from = damaged;
                is_wrong = kind < 6;
            }
            samples->time_ticks = 1000u * (uint32_t)call;
            samples->motor.counts = chance(4) ? (uint32_t)call : (uint32_t)state;
            samples->motor.time_ticks = chance(8) ? samples->time_ticks : (uint32_t)state;
            samples->output = samples->motor;
            samples->has_output = chance(3);
            now->turns = (int32_t)state;
            ahead->turns = now->turns;
            spring->turns = now->turns;
            now->speed_rad_per_s = now->acceleration_rad_per_s2 = 0.0f;
            ahead->speed_rad_per_s = ahead->acceleration_rad_per_s2 = 0.0f;
            now->fraction_turns = ahead->fraction_turns = 0.25f;
            spring->fraction_turns = spring->speed_rad_per_s = spring->torque_Nm = 0.0f;
            spring->stiffness_Nm_per_rad = spring->damping_Nm_s_per_rad = 1.0f;
            samples->motor_torque_Nm = 0.0f;
            if (kind == 7) {
                samples->motor_torque_Nm = number();
            } else if (kind == 10) {
                now->fraction_turns = number();
                is_wrong |= !(now->fraction_turns >= -1.0f && now->fraction_turns <= 1.0f);
                ahead->speed_rad_per_s = number();
            } else if (kind == 11) {
                spring->stiffness_Nm_per_rad = number();
            }
            for (index = 0; index < used; index++) {
                memcpy(buffers[index].before, buffers[index].at, buffers[index].bytes);
            }
            switch (kind) {
            case 0:
            case 1: {
                void *const to = pointer(observer, NULL);
                const size_t bytes = size(sizeof *observer), of = size(sizeof tables_of_test);
                from = (const uint64_t *)pointer((void *)(uintptr_t)from, NULL);
                status = kind == 0u ? joint_observer_start((JointObserver *)to, bytes, from, of)
                                    : joint_observer_start_without_maps((JointObserver *)to, bytes, from, of);
                started[which] |= status == JOINT_STATUS_OK;
                stepped[which] &= status != JOINT_STATUS_OK;
                break;
            }
            case 2: {
                void *const to = pointer(compensation, NULL);
                const size_t bytes = size(sizeof *compensation);
                status = joint_compensation_start((JointCompensation *)to, bytes, from, size(sizeof tables_of_test));
                started[2] |= status == JOINT_STATUS_OK;
                break;
            }
            case 3: {
                void *const to = pointer(plant, NULL);
                status = joint_plant_start((JointPlant *)to, size(sizeof *plant), from, sizeof tables_of_test);
                started[4] |= status == JOINT_STATUS_OK;
                break;
            }
            case 4: {
                void *const to = pointer(probe, NULL);
                status = joint_probe_start((JointProbe *)to, size(sizeof *probe), from, sizeof tables_of_test);
                started[3] |= status == JOINT_STATUS_OK;
                break;
            }
            case 5:
                status = joint_tables_facts(from, size(sizeof tables_of_test), chance(2) ? facts : NULL);
                break;
            case 6:
                /* A moved object is invalid. */
                memcpy(copy, observer, sizeof *copy);
                memcpy(buffers[2].before, copy, sizeof *copy);
                is_wrong = 1;
                status = joint_observer_step(copy, samples);
                break;
            case 7:
            case 8: {
                void *const to = pointer(observer, plant);
                is_wrong |= !started[which];
                status = joint_observer_step((JointObserver *)to, (JointSamples *)pointer(samples, NULL));
                stepped[which] |= status == JOINT_STATUS_OK;
                break;
            }
            case 9: {
                void *const to = pointer(observer, compensation);
                is_wrong |= !started[which];
                status = joint_observer_estimates((JointObserver *)to, (JointEstimates *)pointer(estimates, NULL));
                break;
            }
            case 10: {
                void *const to = pointer(compensation, probe), *const seen = pointer(observer, plant);
                JointMotion *const later = chance(2) ? ahead : NULL;
                is_wrong |= !started[which] || !started[2];
                if (later == NULL && !(ahead->speed_rad_per_s - ahead->speed_rad_per_s == 0.0f)) {
                    /* The library does not read this number. */
                    continue;
                }
                status = joint_compensation_follow((JointCompensation *)to, (JointObserver *)seen,
                                                   (JointMotion *)pointer(now, NULL), later,
                                                   (JointTorque *)pointer(torque, NULL));
                break;
            }
            case 11: {
                void *const to = pointer(compensation, plant), *const seen = pointer(observer, probe);
                is_wrong |= !started[which] || !started[2];
                status = joint_compensation_yield((JointCompensation *)to, (JointObserver *)seen,
                                                  (JointImpedance *)pointer(spring, NULL),
                                                  (JointTorque *)pointer(torque, NULL));
                break;
            }
            case 12: {
                void *const to = pointer(probe, plant), *const seen = pointer(observer, compensation);
                is_wrong |= !started[which] || !started[3];
                status = joint_probe_step((JointProbe *)to, (JointObserver *)seen, (JointProbed *)pointer(probed, NULL));
                break;
            }
            case 13: {
                void *const from_observer = pointer(observer, probe);
                const size_t bytes = size(JOINT_MEMORY_BYTES);
                is_wrong |= !started[which];
                status = joint_observer_save((JointObserver *)from_observer, memory, bytes);
                saved |= status == JOINT_STATUS_OK;
                break;
            }
            case 14: {
                void *const to = pointer(observer, probe);
                const size_t bytes = size(JOINT_MEMORY_BYTES);
                /* The program does not track whether the memory is of this kind of observer. */
                const int sure = is_wrong || !started[which] || stepped[which] || !saved;
                status = joint_observer_load((JointObserver *)to, memory, bytes);
                is_wrong = sure || status != JOINT_STATUS_OK;
                break;
            }
            case 15: {
                void *const to = pointer(plant, observer);
                const float command = number(), push = number();
                is_wrong |= !started[4];
                status = joint_plant_step((JointPlant *)to, command, push);
                break;
            }
            case 16: {
                void *const to = pointer(plant, observer);
                is_wrong |= !started[4];
                status = joint_plant_samples((JointPlant *)to, (JointSamples *)pointer(samples, NULL));
                break;
            }
            case 17: {
                void *const to = pointer(plant, compensation);
                is_wrong |= !started[4];
                status = joint_plant_outputs((JointPlant *)to, (JointPlantOutputs *)pointer(outputs, NULL));
                break;
            }
            case 18: {
                void *const to = pointer(plant, probe);
                is_wrong |= !started[4];
                status = joint_plant_digest((JointPlant *)to, (uint64_t *)pointer(digest, NULL));
                break;
            }
            case 19: {
                void *const to = pointer(plant, observer);
                const float command = number(), inverse_inertia = number(), acceleration = number();
                is_wrong |= !started[4];
                status = joint_plant_step_with_link((JointPlant *)to, command, inverse_inertia, acceleration,
                                                    (float *)pointer(speeds, NULL));
                break;
            }
            case 20: {
                void *const to = pointer(plant, observer);
                const float fraction = number(), speed = number();
                is_wrong |= !started[4] || fraction > 1.0f || fraction < -1.0f;
                status = joint_plant_shift((JointPlant *)to, (int32_t)chance(2000) - 1000, fraction, speed);
                break;
            }
            case 21: {
                void *const to = pointer(plant, compensation);
                is_wrong |= !started[4];
                status = joint_plant_save((JointPlant *)to, (uint32_t *)pointer(state_words, NULL), size(JOINT_PLANT_STATE_WORDS));
                break;
            }
            case 22: {
                void *const to = pointer(plant, probe);
                is_wrong |= !started[4];
                status = joint_plant_speeds((JointPlant *)to, (float *)pointer(speeds, NULL), (float *)pointer(speeds + 1, NULL));
                break;
            }
            case 23: {
                void *const to = pointer(plant, observer);
                uint32_t *const words = (uint32_t *)pointer(state_words, NULL);
                const size_t of = size(JOINT_PLANT_STATE_WORDS);
                const uint32_t at = chance(JOINT_PLANT_STATE_WORDS), bit = chance(4) == 0 ? 1u << chance(32) : 0u;
                /* The program does not track whether the words are a state. */
                const int sure = is_wrong || !started[4] || bit != 0u;
                state_words[at] ^= bit;
                status = joint_plant_load((JointPlant *)to, words, of);
                state_words[at] ^= bit;
                is_wrong = sure || status != JOINT_STATUS_OK;
                break;
            }
            case 24: {
                void *const to = pointer(observer, plant);
                is_wrong |= !started[which];
                status = joint_observer_save_state((JointObserver *)to, (uint32_t *)pointer(observer_words, NULL),
                                                   size(JOINT_OBSERVER_STATE_WORDS));
                break;
            }
            case 25: {
                void *const to = pointer(compensation, probe);
                is_wrong |= !started[2];
                status = joint_compensation_save_state((JointCompensation *)to, (uint32_t *)pointer(compensation_words, NULL),
                                                       size(JOINT_COMPENSATION_STATE_WORDS));
                break;
            }
            case 26: {
                void *const to = pointer(observer, plant);
                uint32_t *const words = (uint32_t *)pointer(observer_words, NULL);
                const size_t of = size(JOINT_OBSERVER_STATE_WORDS);
                const uint32_t at = chance(JOINT_OBSERVER_STATE_WORDS), bit = chance(4) == 0 ? 1u << chance(32) : 0u;
                /* The program does not track whether the words are a state of this kind of observer. */
                const int sure = is_wrong || !started[which] || bit != 0u;
                observer_words[at] ^= bit;
                status = joint_observer_load_state((JointObserver *)to, words, of);
                observer_words[at] ^= bit;
                is_wrong = sure || status != JOINT_STATUS_OK;
                stepped[which] |= status == JOINT_STATUS_OK;
                break;
            }
            case 27: {
                void *const to = pointer(compensation, plant);
                uint32_t *const words = (uint32_t *)pointer(compensation_words, NULL);
                const size_t of = size(JOINT_COMPENSATION_STATE_WORDS);
                const uint32_t at = chance(JOINT_COMPENSATION_STATE_WORDS), bit = chance(4) == 0 ? 1u << chance(32) : 0u;
                const int sure = is_wrong || !started[2] || bit != 0u;
                compensation_words[at] ^= bit;
                status = joint_compensation_load_state((JointCompensation *)to, words, of);
                compensation_words[at] ^= bit;
                is_wrong = sure || status != JOINT_STATUS_OK;
                break;
            }
            default: {
                const uint32_t any = (uint32_t)state;
                is_wrong = 0;
                status = joint_status_name(any) != NULL && joint_status_text(any) != NULL ? JOINT_STATUS_OK : any;
                break;
            }
            }
            if ((status == JOINT_STATUS_OK) == (is_wrong != 0)) {
                say(is_wrong ? "a wrong call was taken" : "a right call was refused");
                say(": kind ");
                say_decimal(kind);
                say(", sequence ");
                say_decimal(sequence);
                say(", ");
                say(joint_status_name(status));
                say("\n");
                return 1;
            }
            for (index = 0; status != JOINT_STATUS_OK && index < used; index++) {
                if (memcmp(buffers[index].before, buffers[index].at, buffers[index].bytes) != 0) {
                    say("a call that was refused has changed something: kind ");
                    say_decimal(kind);
                    say(", buffer ");
                    say_decimal(index);
                    say("\n");
                    return 1;
                }
            }
            if (status == JOINT_STATUS_OK) {
                made++;
            } else {
                refused++;
            }
        }
    }
    say("calls that were right ");
    say_decimal(made);
    say("\ncalls that were refused ");
    say_decimal(refused);
    say("\n");
    return 0;
}
