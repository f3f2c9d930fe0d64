/* Whole swarms for C: a swarm file is read, brought up, taken down and written again, and a drone gets a new process in
   its place. The rules are those of hive.h; what a file may say is in libhive/docs/swarm-file.md. */
#ifndef HIVE_SWARM_H
#define HIVE_SWARM_H

#include <hive.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A swarm file over an application, which finds programs of drones in $HIVE_DRONE_PATH and $PATH. */
typedef struct hive_swarm hive_swarm;

/* `what` is under way: "started", "wired" or "ended". What it returns but HIVE_OK cancels. */
typedef hive_code (*hive_progress_callback)(void* user, size_t done, size_t all, const char* what);
/* Hears a sentence. */
typedef hive_code (*hive_told_callback)(void* user, const char* text);

/* --- the file --- */

/* Finds every mistake that can be found without starting anything: {"mistakes": [{"line", "column", "at", "text",
   "advice"}, ...], "notes": [the same, of what could not be checked here]}. Lines and columns count from 1, in
   characters; "at" is "drones.face.set.scale", and "file" an included file or "". Beside them stands "swarm", its name.
   HIVE_OK says only that it was looked at.
   Options: "timeout_ms" (default 10000) for the programs on this machine, which are asked what they take and produce;
   "form_only" (they are not asked); "folder" (where the file is: without it, it cannot include others); "variables" (an
   object: values for its variables). */
HIVE_API hive_code hive_swarm_check(const char* text, const char* options, char** json, size_t* length);
/* The JSON Schema of swarm files, for editors. */
HIVE_API hive_code hive_swarm_schema(char** json, size_t* length);

/* Of a text with mistakes: HIVE_INVALID_ARGUMENT with the first one; hive_swarm_check() has all. Options: as there. */
HIVE_API hive_code hive_swarm_open(hive_application* application, const char* text, const char* options,
                                   hive_swarm** swarm);
/* From now on each call is HIVE_STOPPED, as it is when the application is closed. The drones go on. Once more: nothing.
 */
HIVE_API hive_code hive_swarm_close(hive_swarm* swarm);
/* Written for what is to run it: "systemd", "compose", "kubernetes", "slurm" or "shell". [{"name", "text", "program"
   (true: to be made executable)}, ...]; the first one says how they are used. Options: "programs" (where hive-KIND is;
   default "/usr/bin"), "image" (of containers; default "hive:latest"). */
HIVE_API hive_code hive_swarm_export(hive_swarm* swarm, const char* form, const char* options, char** json,
                                     size_t* length);

/* --- what runs --- */

/* What hive_swarm_up() would do now: [{"step": "start" | "restart" | "change" | "set" | "connect" | "disconnect" |
   "stop", "drone" (of a connection: the receiver), "what": "face-1 scale=1.05"}, ...]; of a restart, a change and a set
   also "values" and what they were, "before", of connections "sender", "receiver" and "options". HIVE_NAME_TAKEN when a
   name of the file belongs to another kind of drone, or to one on another machine, that this swarm did not have before.
 */
HIVE_API hive_code hive_swarm_differences(hive_swarm* swarm, char** json, size_t* length);
/* Starts what does not run and restarts drones that only a new process can have as the file says, waits until they
   answer, then changes, sets, connects, disconnects and stops what differs: everything or nothing. `timeout_ms` is for
   all drones to be ready. *json: {"steps": [as above; of what failed, what would have been], "failures": [{"drone",
   "error": {"code", "text", "advice"}}, ...], "remains": [the same: what could not be undone]}. HIVE_OK says only that
   it was tried: it is done when both of these are empty. What hive_on_wait() or `progress` cancels is undone, and is a
   failure "stopped". `progress` may be null, and must not call that application.
 */
HIVE_API hive_code hive_swarm_up(hive_swarm* swarm, int64_t timeout_ms, hive_progress_callback progress, void* user,
                                 char** json, size_t* length);
/* Ends all drones: sources take nothing more, and each drone ends when it has handed on what it had. `timeout_ms` is
   for events on their way; then, or when it is cancelled, they are lost. *json as above. */
HIVE_API hive_code hive_swarm_down(hive_swarm* swarm, int64_t timeout_ms, hive_progress_callback progress, void* user,
                                   char** json, size_t* length);
/* Starts drones again that fell and whose "restart" says so, at most 5 times within 60 s each; what was taken down
   stays down until it is brought up again. Returns when `told` returns something but HIVE_OK, which is then its own
   result, and HIVE_STOPPED when hive_on_wait() cancels it or another thread closes the swarm or the application. As
   long as it stays, other calls of this application wait: other threads take one of their own. */
HIVE_API hive_code hive_swarm_stay(hive_swarm* swarm, hive_told_callback told, void* user);

/* The swarms that were brought up from this home: [{"swarm", "text": the file}, ...]. To take one down,
   hive_swarm_open() needs its form only. */
HIVE_API hive_code hive_swarm_remembered(hive_application* application, char** json, size_t* length);
/* What runs, as a swarm file. `swarm`: its name; null: of the only one that was brought up from here, or "swarm".
   `drones`: ["camera", ...]; null: those of the swarm of that name, or all that run if it was not brought up from here.
 */
HIVE_API hive_code hive_swarm_running(hive_application* application, const char* swarm, const char* drones, char** text,
                                      size_t* length);

#ifdef __cplusplus
}
#endif

#endif
