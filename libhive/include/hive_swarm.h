/* Whole swarms for C: reads, starts, stops and writes swarm files. The rules are those of hive.h; the format is in
   libhive/docs/swarm-file.md. */
#ifndef HIVE_SWARM_H
#define HIVE_SWARM_H

#include <hive.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A swarm file over an application, which finds programs of drones in $HIVE_DRONE_PATH and $PATH. */
typedef struct hive_swarm hive_swarm;

/* `what` is in progress: "started", "wired" or "ended". Any result but HIVE_OK cancels. */
typedef hive_code (*hive_progress_callback)(void* user, size_t done, size_t all, const char* what);
/* Receives a sentence. */
typedef hive_code (*hive_told_callback)(void* user, const char* text);

/* --- the file --- */

/* Checks a file without starting anything: {"mistakes": [{"line", "column", "at", "text", "advice"}, ...], "notes":
   [the same, for what could not be checked here]}. Lines and columns count from 1, in characters; "at" is
   "drones.face.set.scale", and "file" an included file or "". "swarm" is its name. HIVE_OK means only that it was
   checked. Options: "timeout_ms" (default 10000) for the programs on this machine to describe their ports and
   parameters; "form_only" (without these); "folder" (where the file is: without it, it cannot include others);
   "variables" (an object: values for its variables). */
HIVE_API hive_code hive_swarm_check(const char* text, const char* options, char** json, size_t* length);
/* The JSON Schema of swarm files, for editors. */
HIVE_API hive_code hive_swarm_schema(char** json, size_t* length);

/* HIVE_INVALID_ARGUMENT with the first mistake of the text; hive_swarm_check() returns all. Options: as there. */
HIVE_API hive_code hive_swarm_open(hive_application* application, const char* text, const char* options,
                                   hive_swarm** swarm);
/* Further calls return HIVE_STOPPED, as after closing the application. The drones keep running. Idempotent. */
HIVE_API hive_code hive_swarm_close(hive_swarm* swarm);
/* Writes it for a service manager: "systemd", "compose", "kubernetes", "slurm" or "shell". [{"name", "text", "program"
   (true: to be made executable)}, ...]; the first one says how to use them. Options: "programs" (where hive-KIND is;
   default "/usr/bin"), "image" (of containers; default "hive:latest"). */
HIVE_API hive_code hive_swarm_export(hive_swarm* swarm, const char* form, const char* options, char** json,
                                     size_t* length);

/* --- what runs --- */

/* What hive_swarm_up() would do now: [{"step": "start" | "restart" | "change" | "set" | "connect" | "disconnect" |
   "stop", "drone" (of a connection: the receiver), "what": "face-1 scale=1.05"}, ...]; of a restart, a change and a set
   also "values" and what they were, "before", of connections "sender", "receiver" and "options". HIVE_NAME_TAKEN if a
   name in the file belongs to another kind of drone, or to one on another machine, that this swarm did not have
   before; HIVE_REFUSED if an engine cannot start a drone from here. */
HIVE_API hive_code hive_swarm_differences(hive_swarm* swarm, char** json, size_t* length);
/* Starts missing drones, restarts those that only a new process can change, waits until they answer, then changes,
   sets, connects, disconnects and stops what differs: all or nothing. `timeout_ms` is for all drones to be ready.
   *json: {"steps": [as above; after a failure, those that were planned], "failures": [{"drone", "error": {"code",
   "text", "advice"}}, ...], "remains": [the same: what could not be undone]}. HIVE_OK means only that it was tried: it
   succeeded if both are empty. A cancellation by hive_on_wait() or `progress` is rolled back, with a failure "stopped".
   `progress` may be null, and must not call that application. */
HIVE_API hive_code hive_swarm_up(hive_swarm* swarm, int64_t timeout_ms, hive_progress_callback progress, void* user,
                                 char** json, size_t* length);
/* Stops all drones: sources first, then each drone once its events are delivered. `timeout_ms` is for events in flight;
   then, or when cancelled, they are lost. *json as above. */
HIVE_API hive_code hive_swarm_down(hive_swarm* swarm, int64_t timeout_ms, hive_progress_callback progress, void* user,
                                   char** json, size_t* length);
/* Restarts crashed drones with "restart", at most 5 times within 60 s each; stopped drones stay down until the next up.
   Returns when `told` returns another result than HIVE_OK, with that result, and HIVE_STOPPED if hive_on_wait() cancels
   it or another thread closes the swarm or the application. Meanwhile other calls of this application wait: use another
   application in other threads. */
HIVE_API hive_code hive_swarm_stay(hive_swarm* swarm, hive_told_callback told, void* user);

/* The swarms that were brought up in this runtime directory: [{"swarm", "text": the file}, ...]. To stop one, open its
   text with "form_only". */
HIVE_API hive_code hive_swarm_remembered(hive_application* application, char** json, size_t* length);
/* The running swarm, as a swarm file. `swarm`: its name; null: that of the only swarm brought up here, or "swarm".
   `drones`: ["camera", ...]; null: those of the swarm of that name, or all running drones if it was not brought up
   here. */
HIVE_API hive_code hive_swarm_running(hive_application* application, const char* swarm, const char* drones, char** text,
                                      size_t* length);

#ifdef __cplusplus
}
#endif

#endif
