/*
 * Footwork: characters of motion matching, moved by trained policies. docs/engines.md tells how to build the
 * library and how to call it from C, Unity, Unreal and Godot.
 *
 * Metres and seconds; y is up, the frame is right-handed; quaternions are x, y, z, w.
 *
 * Every function but the last two returns a status. If it is not FOOTWORK_STATUS_OK, footwork_last_error has a text
 * that says what is wrong and what to do, and nothing has been changed.
 *
 * Every function may be called on every thread. Calls with the same FootworkCharacters wait for each other; others
 * do not. Stepping starts no threads and allocates nothing.
 */

#ifndef FOOTWORK_H
#define FOOTWORK_H

/* Made by cbindgen of src/capi: change it there. */

#include <stddef.h>
#include <stdint.h>

// How a call went. `footwork_last_error` has the text of what is not `FOOTWORK_STATUS_OK`.
typedef enum FootworkStatus {
  // It was done.
  FOOTWORK_STATUS_OK = 0,
  // A pointer that must point somewhere is null.
  FOOTWORK_STATUS_NULL_POINTER = 1,
  // A handle of nothing: zero, closed already, or of something else.
  FOOTWORK_STATUS_INVALID_HANDLE = 2,
  // An array of the wrong size.
  FOOTWORK_STATUS_WRONG_SIZE = 3,
  // There is no joint, character or frame of that number.
  FOOTWORK_STATUS_OUT_OF_RANGE = 4,
  // A value that cannot be: not a number, a text that is not UTF-8, a heading of no length.
  FOOTWORK_STATUS_INVALID_VALUE = 5,
  // Something else must be called first.
  FOOTWORK_STATUS_OUT_OF_ORDER = 6,
  // A file that cannot be read, is damaged, or is something else.
  FOOTWORK_STATUS_CANNOT_READ = 7,
  // The policy was trained with another database.
  FOOTWORK_STATUS_OTHER_DATABASE = 8,
  // The policy cannot do this: it is of another task.
  FOOTWORK_STATUS_UNSUPPORTED = 9,
  // A defect of the library: please report the text.
  FOOTWORK_STATUS_INTERNAL = 10,
} FootworkStatus;

// An open database. Zero is none.
typedef struct FootworkDatabase {
  // Its number.
  uint64_t id;
} FootworkDatabase;

// What a database holds.
typedef struct FootworkDatabaseInfo {
  // Frames of all clips.
  uint32_t frames;
  // Frames that the search can find.
  uint32_t candidates;
  // Clips.
  uint32_t clips;
  // Joints of the skeleton; joint 0 is the root, and parents precede their children.
  uint32_t joints;
  // The number by which a policy knows its database.
  uint32_t fingerprint;
  // Frames a second.
  float frame_rate;
} FootworkDatabaseInfo;

// An open policy. Zero is none.
typedef struct FootworkPolicy {
  // Its number.
  uint64_t id;
} FootworkPolicy;

// What a policy is.
typedef struct FootworkPolicyInfo {
  // The number by which it knows its database.
  uint32_t fingerprint;
  // 1 if it sees obstacles, else 0.
  uint32_t sees_obstacles;
  // The distance to the target that counted as arrival when it learned, m.
  float success_radius;
} FootworkPolicyInfo;

// Open characters. Zero is none.
typedef struct FootworkCharacters {
  // Their number.
  uint64_t id;
} FootworkCharacters;

// An obstacle on the ground: a box along the axes of the world.
typedef struct FootworkObstacle {
  // Its centre, x and z, m.
  float centre[2];
  // Half its sides along x and z, m.
  float half[2];
  // Its velocity along x and z, m/s.
  float velocity[2];
} FootworkObstacle;

// Where a character is, and what has been decided for it.
typedef struct FootworkCharacterState {
  // Position on the ground, x and z, m.
  float position[2];
  // Unit forward direction on the ground, x and z.
  float heading[2];
  // The target on the ground, x and z, m; the origin as long as none was set.
  float target[2];
  // The trajectory that the policy last requested, for 1/3, 2/3 and 1 second ahead: position x, z (m) and heading
  // x, z in the world.
  float requested[3][4];
  // The frame of the database that is shown.
  uint32_t frame;
  // The frame that the last search found.
  uint32_t matched;
} FootworkCharacterState;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Opens the database file at `path` (UTF-8), and the index beside it; without an index it builds one, which takes
// seconds and all cores.
//
// `path` is null or a text that ends with a zero, `database` null or a place for a handle.
enum FootworkStatus footwork_database_open(const char *path,
                                           struct FootworkDatabase *database);

// Closes a database. Characters that were opened with it go on.
enum FootworkStatus footwork_database_close(struct FootworkDatabase database);

// Says what a database holds.
//
// `info` is null or a place for it.
enum FootworkStatus footwork_database_info(struct FootworkDatabase database,
                                           struct FootworkDatabaseInfo *info);

// Copies the name of a joint, UTF-8 with a zero behind it, to `name`, which has `size` bytes.
//
// `name` is null or points to `size` bytes.
enum FootworkStatus footwork_database_joint_name(struct FootworkDatabase database,
                                                 uint32_t joint,
                                                 char *name,
                                                 size_t size);

// Copies the parent of every joint, -1 for the root's, to `parents`, whose size `count` must be the number of
// joints.
//
// `parents` is null or points to `count` numbers.
enum FootworkStatus footwork_database_joint_parents(struct FootworkDatabase database,
                                                    int32_t *parents,
                                                    size_t count);

// Copies the position of every joint relative to its parent, in the parent's frame (x, y, z, m), to `offsets`,
// whose size `count` must be three times the number of joints. The root's is not used.
//
// `offsets` is null or points to `count` numbers.
enum FootworkStatus footwork_database_joint_offsets(struct FootworkDatabase database,
                                                    float *offsets,
                                                    size_t count);

// Finds the frame to play on from: the one nearest to the pose of `frame` and to a requested trajectory. That is 12
// numbers (`count`), for 1/3, 2/3 and 1 second ahead: the position x, z (m) and the unit heading x, z, in the
// character's frame (x to its left, z forward). `found` may be null; so may `distance`, which becomes the squared
// distance of the normalised features.
//
// `trajectory` is null or points to `count` numbers, `found` and `distance` are null or places for a number.
enum FootworkStatus footwork_database_search(struct FootworkDatabase database,
                                             uint32_t frame,
                                             const float *trajectory,
                                             size_t count,
                                             uint32_t *found,
                                             float *distance);

// Opens a policy of the task `plane` or `obstacles`: `path` (UTF-8) is a run's folder, whose last checkpoint is taken,
// or a checkpoint.
//
// `path` is null or a text that ends with a zero, `policy` null or a place for a handle.
enum FootworkStatus footwork_policy_open(const char *path,
                                         struct FootworkPolicy *policy);

// Closes a policy. Characters that were opened with it go on.
enum FootworkStatus footwork_policy_close(struct FootworkPolicy policy);

// Says what a policy is.
//
// `info` is null or a place for it.
enum FootworkStatus footwork_policy_info(struct FootworkPolicy policy,
                                         struct FootworkPolicyInfo *info);

// Opens `count` characters of a database under a policy that was trained with it. They stand at the origin, look along
// z, and have no target.
//
// `characters` is null or a place for a handle.
enum FootworkStatus footwork_characters_open(struct FootworkDatabase database,
                                             struct FootworkPolicy policy,
                                             uint32_t count,
                                             struct FootworkCharacters *characters);

// Closes characters.
enum FootworkStatus footwork_characters_close(struct FootworkCharacters characters);

// Puts a character elsewhere on the ground (m), standing, looking along a direction of any length but 0.
enum FootworkStatus footwork_characters_place(struct FootworkCharacters characters,
                                              uint32_t character,
                                              float x,
                                              float z,
                                              float heading_x,
                                              float heading_z);

// Sends a character to a point on the ground, m. It goes there from its next decision on, in up to a fifth of a
// second.
enum FootworkStatus footwork_characters_set_target(struct FootworkCharacters characters,
                                                   uint32_t character,
                                                   float x,
                                                   float z);

// Says where the obstacles are that a character sees in its next decisions; `count` may be 0. Whoever moves them
// says so again before each step. A policy that sees none refuses.
//
// `obstacles` is null or points to `count` obstacles.
enum FootworkStatus footwork_characters_set_obstacles(struct FootworkCharacters characters,
                                                      uint32_t character,
                                                      const struct FootworkObstacle *obstacles,
                                                      size_t count);

// Moves a character on by a frame, a thirtieth of a second. Every sixth frame its policy decides. It must have a target.
enum FootworkStatus footwork_characters_step(struct FootworkCharacters characters,
                                             uint32_t character);

// Moves all characters on by a frame. All must have a target; if one has none, none moves.
enum FootworkStatus footwork_characters_step_all(struct FootworkCharacters characters);

// Says where a character is.
//
// `state` is null or a place for it.
enum FootworkStatus footwork_characters_state(struct FootworkCharacters characters,
                                              uint32_t character,
                                              struct FootworkCharacterState *state);

// Copies a character's pose as skeletons of engines take it: the root joint's position in the world (x, y, z, m) to
// `root`, of 3 numbers, and each joint's rotation relative to its parent (a quaternion x, y, z, w; the root's relative
// to the world) to `rotations`, whose size `count` must be four times the number of joints.
//
// `root` is null or points to 3 numbers, `rotations` null or to `count`.
enum FootworkStatus footwork_characters_local_pose(struct FootworkCharacters characters,
                                                   uint32_t character,
                                                   float *root,
                                                   float *rotations,
                                                   size_t count);

// Copies a character's joints in the world: their positions (x, y, z, m) to `positions`, whose size
// `position_count` must be three times the number of joints, and their rotations (x, y, z, w) to `rotations`, whose
// size `rotation_count` must be four times that number.
//
// `positions` is null or points to `position_count` numbers, `rotations` null or to `rotation_count`.
enum FootworkStatus footwork_characters_world_pose(struct FootworkCharacters characters,
                                                   uint32_t character,
                                                   float *positions,
                                                   size_t position_count,
                                                   float *rotations,
                                                   size_t rotation_count);

// The text of this thread's last failure, UTF-8; empty if there was none. It may be read until this thread's
// next failure.
const char *footwork_last_error(void);

// The version of the library, as `0.1.0`.
const char *footwork_version(void);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* FOOTWORK_H */
