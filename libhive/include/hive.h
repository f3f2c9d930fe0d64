/* Hive for C, and for every language that can call C: drones and applications, over libhive-c.so. Whole swarms are in
   hive_swarm.h.

   Rules, the same for all functions:
   - A function with a hive_code returns HIVE_OK or the error; hive_error_text() then has its text, per thread.
     Results are written through pointers, only on success. Nothing throws, and a wrong handle crashes nothing.
   - A handle (hive_drone*, hive_event*, ...) is a number, not a pointer. A number is not used twice, so one that was
     released is HIVE_INVALID_ARGUMENT, as is one of another kind, or null.
   - A handle that a function gives you is yours: hive_release() it. hive_retain() adds a reference. Handles that a
     callback gets are lent until it returns: hive_retain() those that you keep.
   - Options, headers and descriptions are JSON, so that they can grow. A null options text means {}. A text without a
     length ends with a zero byte; char** results are freed by hive_free().
   - "User thread" is the thread that runs a drone: the caller of hive_drone_run() or hive_drone_step(), and of the
     declarations before. Callbacks run there, one at a time. A callback returns HIVE_OK, or hive_fail(code, text): that
     becomes an exception of the drone. */
#ifndef HIVE_H
#define HIVE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define HIVE_API __attribute__((visibility("default")))
#else
#define HIVE_API
#endif

/* Grows with each addition: nothing here changes as long as the library is libhive-c.so.0. */
#define HIVE_ABI_VERSION 6

/* --- errors --- */

typedef int32_t hive_code;
enum {
    HIVE_OK = 0,
    HIVE_INVALID_ARGUMENT = 1,  /* an invalid value, name, handle or call */
    HIVE_NOT_FOUND = 2,         /* no such drone, input, output or parameter */
    HIVE_UNREACHABLE = 3,       /* no answer at that address */
    HIVE_CONNECTION_LOST = 4,   /* the peer exited or was disconnected during an operation */
    HIVE_TIMEOUT = 5,           /* the deadline passed before the answer arrived */
    HIVE_REFUSED = 6,           /* the drone refused; the text has its reason */
    HIVE_TYPE_MISMATCH = 7,     /* output and input have different types; the text names both */
    HIVE_HALTED = 8,            /* the drone has halted and accepts nothing until it is resumed */
    HIVE_LOCKED = 9,            /* another set is in progress there; retry shortly */
    HIVE_NAME_TAKEN = 10,       /* a running module has that name already */
    HIVE_NOT_PERMITTED = 11,    /* the peer or the user may not do this */
    HIVE_TOO_LARGE = 12,        /* over a limit */
    HIVE_MALFORMED = 13,        /* bytes or JSON that break the protocol */
    HIVE_VERSION_MISMATCH = 14, /* the peer has another version of the protocol */
    HIVE_UNSUPPORTED = 15,      /* a request that the module does not support */
    HIVE_FAILED = 16,           /* user code failed */
    HIVE_ABANDONED = 17,        /* every attempt at an event failed; it is given up */
    HIVE_STOPPED = 18,          /* the module is ending, or has ended */
    HIVE_IO = 19                /* the operating system refused */
};

/* The last error on this thread; valid until the next one. */
HIVE_API hive_code hive_error_code(void);
HIVE_API const char* hive_error_text(void);
HIVE_API const char* hive_error_advice(void); /* what the caller can do about it */
/* For callbacks: keeps the text, and returns the code. HIVE_OK and unknown codes become HIVE_FAILED. */
HIVE_API hive_code hive_fail(hive_code code, const char* text);

/* For a code: its name in the protocol ("not_found"), its meaning, what the caller can do, and the exit code of a
   program that exits with it. HIVE_OK is "ok"; null or -1 for an unknown code. */
HIVE_API const char* hive_code_token(hive_code code);
HIVE_API const char* hive_code_sentence(hive_code code);
HIVE_API const char* hive_code_advice(hive_code code);
HIVE_API int hive_code_exit_code(hive_code code);

HIVE_API const char* hive_version(void);  /* of Hive: "0.1.0" */
HIVE_API int hive_abi_version(void);      /* HIVE_ABI_VERSION of the library */
HIVE_API int hive_protocol_version(void); /* of what travels between modules */
/* The runtime directory, where drones of this machine connect: $HIVE_HOME, or $XDG_RUNTIME_DIR/hive, or
   /tmp/hive-UID. */
HIVE_API hive_code hive_default_home(char** path);

/* --- handles and texts --- */

typedef struct hive_drone hive_drone;
typedef struct hive_output hive_output;
typedef struct hive_matching hive_matching;
typedef struct hive_event hive_event;
typedef struct hive_body hive_body;
typedef struct hive_loan hive_loan;
typedef struct hive_encoded hive_encoded;
typedef struct hive_application hive_application;
typedef struct hive_collector hive_collector;

HIVE_API hive_code hive_retain(const void* handle);
/* Null: nothing to release. An application or a collector ends with its last reference, and so does a drone. */
HIVE_API hive_code hive_release(const void* handle);
HIVE_API size_t hive_handle_count(void); /* that live in this process, to look for leaks */
HIVE_API void hive_free(void* text);

/* --- events --- */

/* {"source", "epoch", "sequence", "captured_us", "monotonic_us", "lossless", "part": of its capture; "sender", "kind",
   "output", "input", "type", "size" (null: not known), "age_us"; "shares", "hops": [{"drone", "wait_us", "work_us"}]}.
   Times are microseconds; 0 is unknown. */
HIVE_API hive_code hive_event_info(const hive_event* event, char** json, size_t* length);
/* One number of these, without JSON: "epoch", "sequence", "captured_us", "monotonic_us", "part", "size", "age_us". */
HIVE_API hive_code hive_event_number(const hive_event* event, const char* field, int64_t* value);
/* The hop at an index, from 0, of the drones that the event has passed, and the time that it waited and was worked on
   there; `drone` is valid while the handle is. HIVE_NOT_FOUND behind the last one. */
HIVE_API hive_code hive_event_hop(const hive_event* event, size_t index, const char** drone, int64_t* wait_us,
                                  int64_t* work_us);
/* The sender's own header, a JSON object; valid while the handle is. */
HIVE_API hive_code hive_event_header(const hive_event* event, const char** json, size_t* length);
/* The body; valid while the handle is. Empty in a notification. */
HIVE_API hive_code hive_event_bytes(const hive_event* event, const void** bytes, size_t* size);
/* The body as a separate handle: it keeps memory of the sender, but not the event. */
HIVE_API hive_code hive_event_body(const hive_event* event, hive_body** body);
/* Ends the use of an event: it no longer counts as in progress, and its sender may send the next one. Until this call
   it does, as long as a handle exists. The handle stays readable. In a callback it takes effect when the callback
   returns. */
HIVE_API hive_code hive_event_done(hive_event* event);

/* Immutable bytes, shared by all their handles. From any thread. */
HIVE_API hive_code hive_body_new(const void* bytes, size_t size, hive_body** body); /* a copy */
/* Memory of the caller, unchanged until `free_bytes(user)` is called, on any thread. On failure it is not called. */
HIVE_API hive_code hive_body_over(const void* bytes, size_t size, void (*free_bytes)(void* user), void* user,
                                  hive_body** body);
HIVE_API hive_code hive_body_bytes(const hive_body* body, const void** bytes, size_t* size);
/* True if the bytes are in memory of another process, which could still change them: copy before you check and use
   them. */
HIVE_API hive_code hive_body_foreign(const hive_body* body, bool* foreign);

/* A buffer to fill in place; see hive_output_loan(). */
HIVE_API hive_code hive_loan_bytes(const hive_loan* loan, void** bytes, size_t* size);
/* Its first `size` bytes as a body, once; afterwards do not write to it, only release the loan. */
HIVE_API hive_code hive_loan_body(hive_loan* loan, size_t size, hive_body** body);

/* --- a drone: declarations, on the user thread, before it runs --- */

typedef hive_code (*hive_callback)(void* user);
typedef hive_code (*hive_event_callback)(void* user, const hive_event* event);
typedef hive_code (*hive_set_callback)(void* user, const hive_event* const* events, size_t count);
typedef hive_code (*hive_main_callback)(void* user, int64_t* wait_us);
typedef hive_code (*hive_end_callback)(void* user, const char* text);
typedef void (*hive_log_callback)(void* user, const char* line);
/* `level`: "debug", "info", "warning" or "error". */
typedef void (*hive_leveled_log_callback)(void* user, const char* level, const char* line);

/* A drone embedded in another program: it handles neither signals nor process exit nor a log. `kind` is its program
   ("face"), `summary` what it does, in one sentence.
   Options: "name" in the swarm (default: the kind), "stateful" (keeps state between events, so its work cannot be
   shared), initial "parameters" {name: value}, "connect" ["image=camera.image,window=2"] (what it receives, in the form
   of --connect), "on_exception" "skip" or "halt", "halted" (from the start, until it is resumed), "listen" [addresses],
   "advertise" [addresses], "key" (the swarm's key file), "insecure", "no_announce", "remote_operator" (as the options
   of the command line); and: "signals" (SIGINT and SIGTERM stop it), "ends_process" (exit if its code does not return
   within 2 s of a stop). */
HIVE_API hive_code hive_drone_new(const char* kind, const char* summary, const char* options, hive_drone** drone);
/* A program that is a drone: reads the command line that all drones share (--name, --set, --describe, ...), writes its
   log to stderr, and takes signals and the process's end. Options: "stateful". If the arguments were answered (--help)
   or refused, *drone is null, and the program must exit with *exit_code. */
HIVE_API hive_code hive_drone_from_arguments(const char* kind, const char* summary, const char* options, int argc,
                                             const char* const* argv, hive_drone** drone, int* exit_code);
/* A program that is a drone and dies of SIGSEGV, SIGBUS, SIGILL, SIGFPE or SIGABRT writes its stack to its log. The
   runtime of another language writes its own stack to this file descriptor before it calls the handler that it has
   replaced: the trace begins with it. Standard error if this program traces no crash. After
   hive_drone_from_arguments(). */
HIVE_API int hive_stack_descriptor(void);
/* Receives the log lines of a drone made by hive_drone_new(), on any thread, until the drone is released. */
HIVE_API hive_code hive_drone_on_log(hive_drone* drone, hive_log_callback callback, void* user);
/* The same with the level of each line, in place of hive_drone_on_log(). */
HIVE_API hive_code hive_drone_on_leveled_log(hive_drone* drone, hive_leveled_log_callback callback, void* user);
HIVE_API hive_code hive_drone_name(const hive_drone* drone, char** name);

/* The initial value of a parameter: given by --set, or (*remembered) restored after a crash, where --set may repeat it.
 *json is null if it is the default. */
HIVE_API hive_code hive_drone_given(hive_drone* drone, const char* parameter, char** json, bool* remembered);
/* {"name", "type": "integer" | "number" | "flag" | "text", "default", "help"} and, if wanted, "least", "most" (both
   inclusive), "choices" [texts], "unit" ("px"), "operator" (it affects the drone's machine, such as a path or a login:
   over the network only members can set it, and only if the drone allows that). Read and written by hive_drone_values()
   and hive_drone_assign(). */
HIVE_API hive_code hive_drone_parameter(hive_drone* drone, const char* json);
/* The same, bound to a variable, whose present value is the default; a set changes it between two callbacks.
   `constraint`: {"least", "most", "choices", "unit", "operator"} or null. */
HIVE_API hive_code hive_drone_integer(hive_drone* drone, const char* name, int* variable, const char* constraint,
                                      const char* help);
HIVE_API hive_code hive_drone_number(hive_drone* drone, const char* name, double* variable, const char* constraint,
                                     const char* help);
HIVE_API hive_code hive_drone_flag(hive_drone* drone, const char* name, bool* variable, const char* constraint,
                                   const char* help);
/* From here on the variable points to Hive's own text; on_change may point it elsewhere. */
HIVE_API hive_code hive_drone_text(hive_drone* drone, const char* name, const char** variable, const char* constraint,
                                   const char* help);
/* The current values of all parameters: {name: value}. User thread. */
HIVE_API hive_code hive_drone_values(const hive_drone* drone, char** json, size_t* length);
/* Changes variables, in on_start or on_change; the values are reported when that returns. User thread. */
HIVE_API hive_code hive_drone_assign(hive_drone* drone, const char* json);

/* `type`: one media type or several ("image/jpeg,image/png"); the first is the default of emitted events. */
HIVE_API hive_code hive_drone_output(hive_drone* drone, const char* name, const char* type, const char* help,
                                     hive_output** output);
/* The same for an output with other encodings, for receivers that request one, accept nothing else, or are on another
   machine. `encodings`: [{"word": "jpeg", "type": "image/jpeg"}, ...], the preferred one first, which is used for other
   machines; with "least" and "most" the word can have a number ("jpeg:80"). `type` lists the types of the encodings
   too. Emit the event unencoded. The callback gets it with the requested encoding ("jpeg:80"), and answers by
   hive_encoded_give(). It runs on its own thread, one call at a time, in parallel to the user thread, once for all
   receivers of that encoding. Its error is an exception of the drone, and the event is sent as it was emitted. */
typedef hive_code (*hive_encode_callback)(void* user, const hive_event* event, const char* encoding,
                                          hive_encoded* encoded);
HIVE_API hive_code hive_drone_encoded_output(hive_drone* drone, const char* name, const char* type, const char* help,
                                             const char* encodings, hive_encode_callback callback, void* user,
                                             hive_output** output);
/* The event in that encoding: its body, and its header, null for that of the event. */
HIVE_API hive_code hive_encoded_give(hive_encoded* encoded, const char* header, size_t length, const hive_body* body);
HIVE_API hive_code hive_drone_on_event(hive_drone* drone, const char* input, const char* type, const char* help,
                                       hive_event_callback callback, void* user);
/* Declares inputs whose events are matched: [{"name", "type", "help"}, ...], two or more. `match`: null or {} for
   events of one capture, {"tolerance_us": N} for those nearest in time. The callback gets one event of each, in the
   order of the inputs. `check`, if not null, validates each event when it arrives. `matching` may be null. */
HIVE_API hive_code hive_drone_on_matched(hive_drone* drone, const char* inputs, const char* match,
                                         hive_set_callback callback, hive_event_callback check, void* user,
                                         hive_matching** matching);
HIVE_API hive_code hive_matching_rule(hive_matching* matching, const char* match);
/* Called after the parameters of one set were assigned, and once at the start. If it fails, the old values are
   restored, it is called again, and the set is refused with its text. */
HIVE_API hive_code hive_drone_on_change(hive_drone* drone, hive_callback callback, void* user);
/* Called once, when the drone runs: open devices here. If it fails, the drone does not run. */
HIVE_API hive_code hive_drone_on_start(hive_drone* drone, hive_callback callback, void* user);
/* Called when all inputs have ended and every event is processed, before the outputs end too. `text`: what is missing,
   or empty. Called again if more events arrived after all. */
HIVE_API hive_code hive_drone_on_end(hive_drone* drone, hive_end_callback callback, void* user);
/* Called repeatedly between callbacks, for sources; it returns how long to wait before the next call. It is called
   earlier if the demand for an output changes, a parameter was set, or by hive_drone_wake(). */
HIVE_API hive_code hive_drone_main(hive_drone* drone, hive_main_callback callback, void* user);
/* The declarations so far, as --describe prints them. */
HIVE_API hive_code hive_drone_describe(const hive_drone* drone, char** json, size_t* length);

/* --- a drone: running --- */

/* Runs until it is stopped. For --describe it prints the interface instead. A drone runs once. */
HIVE_API hive_code hive_drone_run(hive_drone* drone);
/* The same in steps: join the swarm; work for about time_ms (at least 1), until *goes_on is false; stop, as the request
   `stop` does. */
HIVE_API hive_code hive_drone_start(hive_drone* drone);
HIVE_API hive_code hive_drone_step(hive_drone* drone, int64_t time_ms, bool* goes_on);
HIVE_API hive_code hive_drone_end(hive_drone* drone);

/* From any thread, once it runs. */
HIVE_API hive_code hive_drone_wake(hive_drone* drone); /* calls main as soon as possible */
HIVE_API hive_code hive_drone_stop(hive_drone* drone); /* stops it, as the request `stop` does */
/* Sets the condition of its source ("end of source"; "" or null: none), and the stall reason, null or one of those in
   SPEC.md ("source_ended"). */
HIVE_API hive_code hive_drone_condition(hive_drone* drone, const char* text, const char* reason);
/* Sets the number of events of the current source; 0: unknown or unlimited. */
HIVE_API hive_code hive_drone_source_events(hive_drone* drone, int64_t events);
/* Reports an exception, without failing. */
HIVE_API hive_code hive_drone_report(hive_drone* drone, hive_code code, const char* text);
/* Writes a line to the log, at level "info". */
HIVE_API hive_code hive_drone_log(hive_drone* drone, const char* text);
/* The same at another level: "debug", "info", "warning" or "error". */
HIVE_API hive_code hive_drone_log_at(hive_drone* drone, const char* level, const char* text);
HIVE_API hive_code hive_drone_stopping(const hive_drone* drone, bool* stopping);
/* User thread: the status that an application would get now, {"state", "events", "outputs", "inputs", ...}. */
HIVE_API hive_code hive_drone_status(hive_drone* drone, char** json, size_t* length);

/* Has it receivers of bodies; has it any receivers, even of headers; have all receivers requested another event (for
   sources on demand)? */
HIVE_API hive_code hive_output_wanted(const hive_output* output, bool* wanted);
HIVE_API hive_code hive_output_received(const hive_output* output, bool* received);
HIVE_API hive_code hive_output_asked(const hive_output* output, bool* asked);
/* A buffer for a body, at most 64 MiB (else HIVE_TOO_LARGE), that receivers on this machine read without a copy; never
   waits. From any thread. */
HIVE_API hive_code hive_output_loan(const hive_output* output, size_t size, hive_loan** loan);
/* Sends an event; never waits for a receiver. Inside a callback it inherits identity and time of the input, elsewhere
   it starts a new identity. `header`: a JSON object of `length` bytes, null for {}. `type`: null for the output's
   first. The bytes are copied. User thread, as the functions below. */
HIVE_API hive_code hive_output_emit(hive_output* output, const char* header, size_t length, const void* bytes,
                                    size_t size, const char* type);
/* The same with a body, which is not copied if it is from a loan. Null: no body. */
HIVE_API hive_code hive_output_emit_body(hive_output* output, const char* header, size_t length, const hive_body* body,
                                         const char* type);
/* The same with a body that is made only if it is needed: it has a receiver, or it is from a source on demand and waits
   for the first receiver. `make` returns the handle of a body, whose reference is taken over; it is called before this
   returns, or not at all. Its error is the error of this call. */
typedef hive_code (*hive_body_callback)(void* user, hive_body** body);
HIVE_API hive_code hive_output_emit_made(hive_output* output, const char* header, size_t length,
                                         hive_body_callback make, void* user, const char* type);
/* Starts an identity captured at that time (microseconds since 1970). `lossless`: of a source on demand. To make bodies
   only if needed, see hive_output_emit_made(). */
HIVE_API hive_code hive_output_emit_captured(hive_output* output, int64_t captured_us, bool lossless,
                                             const char* header, size_t length, const hive_body* body,
                                             const char* type);
HIVE_API hive_code hive_output_emit_captured_made(hive_output* output, int64_t captured_us, bool lossless,
                                                  const char* header, size_t length, hive_body_callback make,
                                                  void* user, const char* type);
/* For main: reports a capture without an event, such as a damaged file; it uses up its number. Always fails, with that
   code; let main return it. */
HIVE_API hive_code hive_output_fail(hive_output* output, int64_t captured_us, bool lossless, hive_code code,
                                    const char* text);
/* Sends an event again, unchanged and with its identity. */
HIVE_API hive_code hive_output_repeat(hive_output* output, const hive_event* event);
/* Ends the source: nothing more will come, unless something is emitted after all. Drones pass it on, so that collectors
   know that they have everything. `text`: what is lacking ("87 of 196 frames: the file is damaged"); null or "":
   nothing. */
HIVE_API hive_code hive_output_end(hive_output* output, const char* text);
/* Starts another source: captures are numbered from 1. After an end this is implied; called anyway, it revokes the end
   at once, before the first event. */
HIVE_API hive_code hive_output_begin_source(hive_output* output);

/* --- an application --- */

/* Calls block until they are confirmed or their deadline has passed (HIVE_TIMEOUT). Calls from several threads are
   serialized. After hive_application_close(), and with collectors of a closed application, each is HIVE_STOPPED. An end
   of a connection is "camera.image", or "camera" if only one port fits. HIVE_NOT_PERMITTED: the key or role does not
   allow it. Options: "name" (default "app-PID"), "home" (default $HIVE_HOME, ...), "timeout_ms" (default 5000), "key"
   (the swarm's key file, for drones on other machines; default $HIVE_KEY, or ~/.config/hive/swarm.key). */
HIVE_API hive_code hive_application_new(const char* options, hive_application** application);
/* Leaves the swarm; waits for calls in progress on other threads. Idempotent. */
HIVE_API hive_code hive_application_close(hive_application* application);
HIVE_API hive_code hive_application_name(const hive_application* application, char** name);
HIVE_API hive_code hive_application_timeout(hive_application* application, int64_t timeout_ms);

/* ["camera", ...]: the drones running on this and other known machines; crashed drones whose state is saved; the drones
   that match a glob or a name (HIVE_NOT_FOUND if none does). */
HIVE_API hive_code hive_application_drones(hive_application* application, char** json, size_t* length);
HIVE_API hive_code hive_application_remembered(hive_application* application, char** json, size_t* length);
HIVE_API hive_code hive_application_find(hive_application* application, const char* pattern, char** json,
                                         size_t* length);
HIVE_API hive_code hive_application_describe(hive_application* application, const char* drone, char** json,
                                             size_t* length);
HIVE_API hive_code hive_application_status(hive_application* application, const char* drone, char** json,
                                           size_t* length);
/* Of ["camera", ...] at once: [{"drone", "place", "status"} or {"drone", "place", "error": {"code", "text", "advice"}},
   ...], in this order. */
HIVE_API hive_code hive_application_status_all(hive_application* application, const char* drones, char** json,
                                               size_t* length);
/* Where a drone is reachable: {"drone", "host" ("local": this machine), "address", "ssh", "answered_us"}. A drone is
   called "NAME@HOST" if several have the same name. */
HIVE_API hive_code hive_application_place(hive_application* application, const char* drone, char** json,
                                          size_t* length);
/* The list of places: addresses of drones on other machines. [{"drone", ...}, ...] */
HIVE_API hive_code hive_application_places(hive_application* application, char** json, size_t* length);
/* Adds a place to the list: {"drone", "host", "address": "tcp://HOST:PORT", "ssh"}. */
HIVE_API hive_code hive_application_add_place(hive_application* application, const char* place);
/* Removes a place, as returned by hive_application_places(), from the list. HIVE_NOT_FOUND: not in the list. */
HIVE_API hive_code hive_application_forget_place(hive_application* application, const char* place);
/* Returns when the drone is "running" (started and answering), "idle", "halted" or "gone". */
HIVE_API hive_code hive_application_wait(hive_application* application, const char* drone, const char* state,
                                         int64_t timeout_ms);

/* Options: "transfer" "sync" | "stream", "delivery" "data" | "notify", "window" 1 to 64, "group", "first_frame",
   "lease_ms", "encoding". *ends: {"sender": "camera.image", "receiver": "face.image"}; may be null. */
HIVE_API hive_code hive_application_connect(hive_application* application, const char* sender, const char* receiver,
                                            const char* options, char** ends);
HIVE_API hive_code hive_application_disconnect(hive_application* application, const char* sender, const char* receiver);

/* Sets {name: value}, all or none. *applied, if not null: the applied values. */
HIVE_API hive_code hive_application_set(hive_application* application, const char* drone, const char* parameters,
                                        char** applied);
/* On all of ["face-1", ...] or on none. *result: {"changed": "all" | "none" | "unclear", "answers": [{"drone",
   "result"} or {"drone", "error": {"code", "text", "advice"}}, ...]}. HIVE_OK means only that it was tried.
   `cancelled`, if not null, is polled; any result but HIVE_OK cancels. */
HIVE_API hive_code hive_application_set_all(hive_application* application, const char* drones, const char* parameters,
                                            hive_callback cancelled, void* user, char** result);
/* `names`: ["scale", ...], null for all. */
HIVE_API hive_code hive_application_get(hive_application* application, const char* drone, const char* names,
                                        char** values);
/* *answers as in set_all. */
HIVE_API hive_code hive_application_get_all(hive_application* application, const char* drones, const char* names,
                                            char** answers);

/* Receives from ["face.faces", ...]. Options: "connection" {as for connect; "window" 64}, "ordered",
 * "reorder_timeout_ms". */
HIVE_API hive_code hive_application_collect(hive_application* application, const char* outputs, const char* options,
                                            hive_collector** collector);
/* Receives sets of events that belong together, one of each of two or more outputs; `match` as for
   hive_drone_on_matched(). */
HIVE_API hive_code hive_application_collect_matched(hive_application* application, const char* outputs,
                                                    const char* match, const char* options, hive_collector** collector);
/* Receives the exceptions of ["face", ...]: events whose header has "code", "text", "policy", "input". */
HIVE_API hive_code hive_application_exceptions(hive_application* application, const char* drones,
                                               hive_collector** collector);
/* Sends one event into "drone.input". */
HIVE_API hive_code hive_application_put(hive_application* application, const char* input, const char* header,
                                        size_t length, const void* bytes, size_t size, const char* type);
/* Starts a drone in the background and returns when it is ready; it keeps running when this program exits. `kind`: the
   program hive-KIND in $HIVE_DRONE_PATH or $PATH, or a Python file. Options: "name" (default: the kind), "ssh" (host of
   another machine for ssh), "parameters" {name: value}, "ready_ms" (default 10000), "if_missing" (reuse a running drone
   of this name and kind), and as in a swarm file "on_exception", "halted", "listen", "advertise", "key", "insecure",
   "no_announce", "remote_operator", "log_level". *place, if not null: as of hive_application_place(). HIVE_NAME_TAKEN
   if a drone has the name; if it exits instead, the error with its exit code, or HIVE_FAILED, with the end of its
   log. */
HIVE_API hive_code hive_application_start(hive_application* application, const char* kind, const char* options,
                                          char** place);
/* Replaces a running drone with a new process, which takes over name, addresses, parameters and connections once it is
   ready. Options as of hive_application_start(), without "name", "ssh" and "if_missing", and "kind" (default: that of
   the old drone), "lose_state" (replace even a stateful drone, without its state), "force" (kill a drone that does not
   answer within 3 s or is of another version, and start a new one with its parameters and connections); other options
   are those of the old drone, or the defaults with "force". Until the new process is ready, an error or a cancellation
   leaves the old drone unaffected; then the replacement continues by itself. */
HIVE_API hive_code hive_application_replace(hive_application* application, const char* drone, const char* options,
                                            char** place);
/* The causes of a stall of ["face", "face.faces", ...]; []: of any drone; {"sender": "camera", "receiver": "face"}: of
   the events between these two, and whether they are connected. {"text": one line; "" if nothing blocks the
   events, "causes": [{"what": "halted", "drone", "connection", "text", "evidence", "command", "blocks"}], blocking ones
   first, the nearest to the source on top, "flows": [{"drone", "received_per_s", "emitted_per_s", "age_us"}]}. Takes
   two samples, 300 ms apart. */
HIVE_API hive_code hive_application_explain(hive_application* application, const char* outputs, char** json,
                                            size_t* length);
/* Where events spend their time, and what would help: {"goal", "lines": [{"from", "to", "per_s", "latency_us",
   "stations": [{"what", "at", "time_us", "max_per_s"}], "limits": the same, the bottleneck first, "proposals":
   [{"what", "text", "command", "predicted_per_s", "predicted_us", "next", "sure", "unsure"}], the best first}]}, as
   described in hivectl advise --help. `drones`: ["face"], or the first and the last drone of a pipeline; []: all
   pipelines. Options: {"goal": "fps" (default) or "latency", "time_ms": how long to measure, default 2000}. */
HIVE_API hive_code hive_application_advise(hive_application* application, const char* drones, const char* options,
                                           char** json, size_t* length);
/* Whether anything was lost: {"clean": false if it was, "connections": [{"from", "to", "state", "came", a count for
   each fate, "in_flight", "received", "processed", "lost", "fates": a text, "losses": [{"fate", "at", "events",
   "promised", "last_us": wall clock of the newest, "reason"}], "differences": [text], "verdict": "ok", "lost" or
   "differs"}], "silent": [drones that did not answer]}. A count is null if its end did not answer. Queries all drones
   three times. */
HIVE_API hive_code hive_application_audit(hive_application* application, char** json, size_t* length);
/* The drones and connections of the swarm: {"drones": [{"name", "host", "kind", "state", "note"}], "connections":
   [{"from", "to", "group", "connected"}]}. "host" is "local" for this machine, and "" for an application or a drone
   that is unknown here; "state" is "silent" without an answer, "crashed" or "failed" (then "note" says why), and "gone"
   for a receiver that its sender awaits or counts losses for. */
HIVE_API hive_code hive_application_graph(hive_application* application, char** json, size_t* length);
/* The counters of the swarm, as hivectl metrics --json prints them: [{"name": "hive_drone_busy_seconds", "type":
   "counter", "gauge", "info" or "stateset", "help", "unit", "samples": [{"labels": {name: text}, "value", "created_us":
   wall clock at which a counter was 0}]}]. A name lacks the "_total" or "_info" of the text forms; "unit" and
   "created_us" are left out if there is none. A drone that does not answer has "hive_drone_up" 0 and nothing else. */
HIVE_API hive_code hive_application_metrics(hive_application* application, char** json, size_t* length);
/* The failures of a drone that are kept on this machine, by number: [{"drone", "number", "time_us", "code", "text",
   "inputs": [{"input", "sender", "type", "size", "source", "epoch", "seq", "header"}]}]. "code" is that of an error, or
   "died", "silent" (disconnected) or "late" (exceeded its lease). The drone need not run. */
HIVE_API hive_code hive_application_failures(hive_application* application, const char* drone, char** json,
                                             size_t* length);
/* Reruns the inputs of a failure in a new drone of the same kind, outside of the swarm: {"outcome": "passed", "threw",
   "died" or "hung", "code", "text", "emitted", "unfit": [how it differs from the drone of a file], "log"}. `drone` may
   be a file of hivectl rerun --save: a path with a slash, or NAME.failure. `number` 0: the newest. Options: {"kind",
   "program": of another build, "parameters": in addition to those of the drone, "under": ["valgrind"], "limit_ms":
   default 30000, "on": the ssh host of the machine that keeps the failure}. For the main thread: when it exits, so does
   the new drone. */
HIVE_API hive_code hive_application_rerun(hive_application* application, const char* drone, int64_t number,
                                          const char* options, char** json, size_t* length);
HIVE_API hive_code hive_application_halt(hive_application* application, const char* drone);
HIVE_API hive_code hive_application_resume(hive_application* application, const char* drone);
HIVE_API hive_code hive_application_stop(hive_application* application, const char* drone);
/* "skip" or "halt": the action when its code throws. */
HIVE_API hive_code hive_application_exception_policy(hive_application* application, const char* drone,
                                                     const char* policy);

/* Sets a callback of this thread that is polled while a call of any application or collector waits. Any result but
   HIVE_OK ends the call with HIVE_STOPPED; its outcome is then unknown. It must not call that application. Null: no
   callback. */
HIVE_API hive_code hive_on_wait(hive_callback callback, void* user);

/* The next event; *event is null if none arrived in time, and at once if everything has ended. */
HIVE_API hive_code hive_collector_next(hive_collector* collector, int64_t timeout_ms, hive_event** event);
/* Of a collector of sets: fills events[0] to events[*count - 1]; *count is 0 if none was complete in time, and at once
   if everything has ended. HIVE_TOO_LARGE: a set has more events than `capacity`. */
HIVE_API hive_code hive_collector_next_set(hive_collector* collector, int64_t timeout_ms, hive_event** events,
                                           size_t capacity, size_t* count);
/* {"received", "duplicates", "missing", "missing_turns", "failed", "dropped"}, and of sets "sets": {"sets", "waiting",
   "unmatched", "duplicates", "missing"}. */
HIVE_API hive_code hive_collector_counts(hive_collector* collector, char** json, size_t* length);
/* One of these without JSON: "received", "duplicates", "missing", "failed", "dropped", or of sets "sets", "waiting",
   "unmatched". */
HIVE_API hive_code hive_collector_count(hive_collector* collector, const char* counter, int64_t* value);
/* This end of each connection, as a drone's status has it (SPEC.md, section 6.4): [{"input", "from" ("camera.image"),
   "connected", "received", "queued", "last_age_us", "error", "why", ...}]; values that are 0, false or empty are
   omitted. */
HIVE_API hive_code hive_collector_inputs(hive_collector* collector, char** json, size_t* length);
/* True if all outputs have ended and every event was taken. *text, if not null, is then what is missing, or "". It
   becomes false again if another event arrives. */
HIVE_API hive_code hive_collector_ended(hive_collector* collector, bool* ended, char** text);
/* Stops receiving. The handle stays valid, but has no counts any more. Idempotent. */
HIVE_API hive_code hive_collector_close(hive_collector* collector);

#ifdef __cplusplus
}
#endif

#endif
