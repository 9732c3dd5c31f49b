/*
 * A character walks to targets by a trained policy:
 *
 *     footwork data synth --minutes 3 --out motion.footwork
 *     footwork train plane --data motion.footwork --out run
 *     cc -Iinclude examples/c/walk.c -Ltarget/release -lfootwork -lm -o walk
 *     LD_LIBRARY_PATH=target/release ./walk motion.footwork run
 *
 * Prints the path, and at the end what a step costs.
 */

#include "footwork.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* Frames after which a target is given up: 20 seconds. */
#define PATIENCE 600

static const float TARGETS[][2] = {{3.0f, 4.0f}, {-4.0f, 2.0f}, {-1.0f, -5.0f}, {4.0f, -1.0f}};
#define TARGET_COUNT (sizeof TARGETS / sizeof TARGETS[0])

static void check(FootworkStatus status) {
    if (status != FOOTWORK_STATUS_OK) {
        fprintf(stderr, "walk: %s\n", footwork_last_error());
        exit(1);
    }
}

static double microseconds(void) {
    struct timespec now;
    timespec_get(&now, TIME_UTC);
    return 1e6 * (double)now.tv_sec + 1e-3 * (double)now.tv_nsec;
}

/* Microseconds that frames took. */
typedef struct Times {
    double all[TARGET_COUNT * PATIENCE];
    size_t count;
} Times;

static int ascending(const void *a, const void *b) {
    double first = *(const double *)a, second = *(const double *)b;
    return (first > second) - (first < second);
}

/* Half of the frames took no longer. */
static double median(Times *times) {
    qsort(times->all, times->count, sizeof times->all[0], ascending);
    return times->count > 0 ? times->all[times->count / 2] : 0.0;
}

/* Frames in which the policy decides, and the others. */
static Times decisions, others;

/* Walks to a target. Returns the time it took, in seconds, or -1 for never. */
static double walk(FootworkCharacters characters, const float target[2], float radius, float *pose,
                   uint32_t joints) {
    check(footwork_characters_set_target(characters, 0, target[0], target[1]));
    for (int frame = 1; frame <= PATIENCE; frame++) {
        FootworkCharacterState state;
        double begin = microseconds();
        check(footwork_characters_step(characters, 0));
        check(footwork_characters_local_pose(characters, 0, pose, pose + 3, 4 * (size_t)joints));
        double spent = microseconds() - begin;
        check(footwork_characters_state(characters, 0, &state));
        /* A decision's first frame follows the frame that was found. */
        Times *times = state.frame == state.matched + 1 ? &decisions : &others;
        times->all[times->count++] = spent;
        double away = hypot(target[0] - state.position[0], target[1] - state.position[1]);
        if (frame % 30 == 0 || away <= radius) {
            printf("%5.2f s  at %6.2f, %6.2f m  hips %.2f m high  %5.2f m to go\n", frame / 30.0,
                   state.position[0], state.position[1], pose[1], away);
        }
        if (away <= radius) {
            return frame / 30.0;
        }
    }
    return -1.0;
}

int main(int argc, char **argv) {
    if (argc != 3) {
        fprintf(stderr, "usage: walk DATABASE RUN\n");
        return 2;
    }
    FootworkDatabase database;
    FootworkDatabaseInfo motion;
    check(footwork_database_open(argv[1], &database));
    check(footwork_database_info(database, &motion));
    FootworkPolicy policy;
    FootworkPolicyInfo learned;
    check(footwork_policy_open(argv[2], &policy));
    check(footwork_policy_info(policy, &learned));
    FootworkCharacters characters;
    check(footwork_characters_open(database, policy, 1, &characters));
    if (learned.sees_obstacles) {
        FootworkObstacle post = {{0.0f, 2.5f}, {0.3f, 0.3f}, {0.0f, 0.0f}};
        check(footwork_characters_set_obstacles(characters, 0, &post, 1));
    }
    char root[256];
    check(footwork_database_joint_name(database, 0, root, sizeof root));
    printf("footwork %s: %u frames, %u joints below %s\n", footwork_version(), motion.frames,
           motion.joints, root);

    /* The root's position, and four numbers a joint. */
    float *pose = calloc(3 + 4 * (size_t)motion.joints, sizeof *pose);
    if (pose == NULL) {
        return 1;
    }
    size_t arrived = 0;
    for (size_t i = 0; i < TARGET_COUNT; i++) {
        printf("to %.0f, %.0f\n", TARGETS[i][0], TARGETS[i][1]);
        double time = walk(characters, TARGETS[i], learned.success_radius, pose, motion.joints);
        arrived += time >= 0.0;
    }
    printf("%zu of %zu targets reached\n", arrived, TARGET_COUNT);
    printf("half of the frames with a decision take at most %.1f microseconds, of the others %.1f\n",
           median(&decisions), median(&others));
    free(pose);
    check(footwork_characters_close(characters));
    check(footwork_policy_close(policy));
    check(footwork_database_close(database));
    return arrived == TARGET_COUNT ? 0 : 1;
}
