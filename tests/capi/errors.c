/* Everything that a caller can do wrong is answered by a status and a text. */

#include "footwork.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures = 0;

/* Compares a status, and looks for a part of its text. */
#define EXPECT(call, wanted, part)                                                              \
    do {                                                                                        \
        FootworkStatus status = (call);                                                         \
        const char *text = footwork_last_error();                                               \
        if (status != (wanted) || (status != FOOTWORK_STATUS_OK && !strstr(text, part))) {      \
            fprintf(stderr, "line %d: %s\n  status %d, text: %s\n", __LINE__, #call, status, text); \
            failures++;                                                                         \
        }                                                                                       \
    } while (0)

#define OK(call) EXPECT(call, FOOTWORK_STATUS_OK, "")
#define NULL_POINTER(call, part) EXPECT(call, FOOTWORK_STATUS_NULL_POINTER, part)
#define INVALID_HANDLE(call, part) EXPECT(call, FOOTWORK_STATUS_INVALID_HANDLE, part)
#define WRONG_SIZE(call, part) EXPECT(call, FOOTWORK_STATUS_WRONG_SIZE, part)
#define OUT_OF_RANGE(call, part) EXPECT(call, FOOTWORK_STATUS_OUT_OF_RANGE, part)
#define INVALID_VALUE(call, part) EXPECT(call, FOOTWORK_STATUS_INVALID_VALUE, part)
#define CANNOT_READ(call, part) EXPECT(call, FOOTWORK_STATUS_CANNOT_READ, part)

static void databases(const char *path, FootworkDatabase *database) {
    FootworkDatabaseInfo info;
    FootworkDatabase none = {0}, unknown = {1u << 30};
    CANNOT_READ(footwork_database_open("nowhere", database), "cannot read nowhere");
    CANNOT_READ(footwork_database_open(".", database), "cannot read");
    CANNOT_READ(footwork_database_open(__FILE__, database), "is not a footwork database");
    NULL_POINTER(footwork_database_open(NULL, database), "`path` is null");
    NULL_POINTER(footwork_database_open(path, NULL), "`database` is null");
    INVALID_VALUE(footwork_database_open("\xff", database), "not UTF-8");
    INVALID_HANDLE(footwork_database_info(none, &info), "open a database first");
    INVALID_HANDLE(footwork_database_info(unknown, &info), "not that of a database");
    INVALID_HANDLE(footwork_database_close(none), "open a database first");
    OK(footwork_database_open(path, database));
    NULL_POINTER(footwork_database_info(*database, NULL), "`info` is null");
    OK(footwork_database_info(*database, &info));

    char name[64];
    int32_t parents[256];
    float offsets[768];
    OK(footwork_database_joint_name(*database, 0, name, sizeof name));
    WRONG_SIZE(footwork_database_joint_name(*database, 0, name, strlen(name)), "or more");
    WRONG_SIZE(footwork_database_joint_name(*database, 0, name, 0), "or more");
    NULL_POINTER(footwork_database_joint_name(*database, 0, NULL, 64), "`name` is null");
    OUT_OF_RANGE(footwork_database_joint_name(*database, info.joints, name, 64), "no joint");
    OK(footwork_database_joint_parents(*database, parents, info.joints));
    WRONG_SIZE(footwork_database_joint_parents(*database, parents, info.joints + 1), "`parents`");
    NULL_POINTER(footwork_database_joint_parents(*database, NULL, info.joints), "`parents`");
    OK(footwork_database_joint_offsets(*database, offsets, 3 * info.joints));
    WRONG_SIZE(footwork_database_joint_offsets(*database, offsets, info.joints), "`offsets`");
    if (parents[0] != -1 || parents[1] != 0) {
        fprintf(stderr, "the root's parent is %d, its child's %d\n", parents[0], parents[1]);
        failures++;
    }

    float ahead[12] = {0, 0.5f, 0, 1, 0, 1, 0, 1, 0, 1.5f, 0, 1};
    uint32_t found = UINT32_MAX;
    float distance = -1;
    OK(footwork_database_search(*database, 0, ahead, 12, &found, &distance));
    if (found >= info.frames || !(distance >= 0)) {
        fprintf(stderr, "found the frame %u at a distance of %f\n", found, distance);
        failures++;
    }
    OK(footwork_database_search(*database, 0, ahead, 12, NULL, NULL));
    WRONG_SIZE(footwork_database_search(*database, 0, ahead, 11, &found, NULL), "not 12");
    NULL_POINTER(footwork_database_search(*database, 0, NULL, 12, &found, NULL), "`trajectory`");
    OUT_OF_RANGE(footwork_database_search(*database, info.frames, ahead, 12, &found, NULL), "no frame");
    ahead[3] = NAN;
    INVALID_VALUE(footwork_database_search(*database, 0, ahead, 12, &found, NULL), "not finite");
}

static void policies(const char *database, const char *run, FootworkPolicy *policy) {
    FootworkPolicyInfo info;
    FootworkPolicy none = {0};
    CANNOT_READ(footwork_policy_open("nowhere", policy), "nowhere");
    CANNOT_READ(footwork_policy_open(database, policy), "not a checkpoint");
    NULL_POINTER(footwork_policy_open(NULL, policy), "`path` is null");
    NULL_POINTER(footwork_policy_open(run, NULL), "`policy` is null");
    INVALID_HANDLE(footwork_policy_info(none, &info), "open a policy first");
    OK(footwork_policy_open(run, policy));
    NULL_POINTER(footwork_policy_info(*policy, NULL), "`info` is null");
    OK(footwork_policy_info(*policy, &info));
}

static void characters(FootworkDatabase database, FootworkPolicy policy) {
    FootworkCharacters all, none = {0};
    FootworkCharacterState state;
    FootworkDatabaseInfo info;
    OK(footwork_database_info(database, &info));
    /* Handles of another kind. */
    FootworkDatabase no_database = {policy.id};
    FootworkPolicy no_policy = {database.id};
    INVALID_HANDLE(footwork_characters_open(no_database, policy, 1, &all), "not that of a database");
    INVALID_HANDLE(footwork_characters_open(database, no_policy, 1, &all), "not that of a policy");
    NULL_POINTER(footwork_characters_open(database, policy, 1, NULL), "`characters` is null");
    INVALID_VALUE(footwork_characters_open(database, policy, 0, &all), "from 1 to");
    INVALID_VALUE(footwork_characters_open(database, policy, UINT32_MAX, &all), "from 1 to");
    OK(footwork_characters_open(database, policy, 2, &all));

    EXPECT(footwork_characters_step(all, 0), FOOTWORK_STATUS_OUT_OF_ORDER, "set_target first");
    OK(footwork_characters_set_target(all, 0, 1, 1));
    OK(footwork_characters_step(all, 0));
    EXPECT(footwork_characters_step_all(all), FOOTWORK_STATUS_OUT_OF_ORDER, "character 1 has no target");
    OUT_OF_RANGE(footwork_characters_set_target(all, 2, 1, 1), "no character 2");
    INVALID_VALUE(footwork_characters_set_target(all, 1, INFINITY, 1), "not finite");
    OK(footwork_characters_set_target(all, 1, 1e30f, 1));
    for (int frame = 0; frame < 30; frame++) {
        OK(footwork_characters_step_all(all));
    }
    INVALID_VALUE(footwork_characters_place(all, 0, NAN, 0, 0, 1), "`position`");
    INVALID_VALUE(footwork_characters_place(all, 0, 0, 0, 0, 0), "no direction");
    OK(footwork_characters_place(all, 0, 2, 3, 0, -5));
    OK(footwork_characters_state(all, 0, &state));
    if (state.position[0] != 2 || state.position[1] != 3 || state.heading[1] != -1) {
        fprintf(stderr, "it does not stand where it was placed\n");
        failures++;
    }
    NULL_POINTER(footwork_characters_state(all, 0, NULL), "`state` is null");

    size_t joints = info.joints;
    float root[3], *numbers = calloc(8 * joints, sizeof *numbers), *more = numbers + 4 * joints;
    OK(footwork_characters_local_pose(all, 0, root, numbers, 4 * joints));
    WRONG_SIZE(footwork_characters_local_pose(all, 0, root, numbers, joints), "`rotations`");
    NULL_POINTER(footwork_characters_local_pose(all, 0, NULL, numbers, 4 * joints), "`root`");
    OK(footwork_characters_world_pose(all, 0, numbers, 3 * joints, more, 4 * joints));
    WRONG_SIZE(footwork_characters_world_pose(all, 0, numbers, 1, more, 4 * joints), "`positions`");
    OUT_OF_RANGE(footwork_characters_world_pose(all, 9, numbers, 3 * joints, more, 4 * joints), "no character 9");
    free(numbers);

    FootworkObstacle post = {{1, 1}, {0.5f, 0.5f}, {0, 0}};
    FootworkPolicyInfo learned;
    OK(footwork_policy_info(policy, &learned));
    if (learned.sees_obstacles) {
        OK(footwork_characters_set_obstacles(all, 0, &post, 1));
        OK(footwork_characters_set_obstacles(all, 0, NULL, 0));
        NULL_POINTER(footwork_characters_set_obstacles(all, 0, NULL, 1), "`obstacles` is null");
        WRONG_SIZE(footwork_characters_set_obstacles(all, 0, &post, SIZE_MAX), "memory");
        post.half[0] = NAN;
        INVALID_VALUE(footwork_characters_set_obstacles(all, 0, &post, 1), "not finite");
    } else {
        EXPECT(footwork_characters_set_obstacles(all, 0, &post, 1), FOOTWORK_STATUS_UNSUPPORTED, "sees no obstacles");
    }

    /* They go on without what they were opened with, and end once. */
    OK(footwork_database_close(database));
    OK(footwork_policy_close(policy));
    INVALID_HANDLE(footwork_database_close(database), "it was closed");
    OK(footwork_characters_step_all(all));
    OK(footwork_characters_close(all));
    INVALID_HANDLE(footwork_characters_close(all), "it was closed");
    INVALID_HANDLE(footwork_characters_step(all, 0), "it was closed");
    INVALID_HANDLE(footwork_characters_step(none, 0), "open characters first");
}

int main(int argc, char **argv) {
    if (argc != 4) {
        fprintf(stderr, "usage: errors DATABASE RUN RUN_WITH_OTHER_DATA\n");
        return 2;
    }
    if (strlen(footwork_last_error()) != 0) {
        failures++;
    }
    FootworkDatabase database = {0};
    FootworkPolicy policy = {0}, other = {0};
    databases(argv[1], &database);
    policies(argv[1], argv[2], &policy);
    OK(footwork_policy_open(argv[3], &other));
    FootworkCharacters none;
    EXPECT(footwork_characters_open(database, other, 1, &none), FOOTWORK_STATUS_OTHER_DATABASE, "another database");
    characters(database, policy);
    printf("%s: %d failures\n", argv[2], failures);
    return failures > 0;
}
