/* Hive for C, and for every language that can call C: drones and applications, over libhive-c.so. Whole swarms are in
   hive_swarm.h.

   Rules, the same for all functions:
   - What returns hive_code returns HIVE_OK or why it failed; hive_error_text() then says it in words, for this thread.
     Results come through pointers and are set only on success. Nothing throws, nothing crashes for a wrong handle.
   - A handle (hive_drone*, hive_event*, ...) is a number, no address: never look behind it. A number is not used twice,
     so one that was released is HIVE_INVALID_ARGUMENT, as is one of another kind, or null.
   - A handle that a function gives you is yours: hive_release() it. hive_retain() adds a reference. Handles that a
     callback gets are lent until it returns: hive_retain() what is to be kept.
   - What cannot be told yet travels as JSON, so that it can grow: options, headers, descriptions. A null options text
     means {}. A text without a length ends with a zero byte; char** results are freed by hive_free().
   - "User thread" is the one that runs a drone: the caller of hive_drone_run() or hive_drone_step(), and of what is
     declared before. Callbacks come there, one at a time. A callback returns HIVE_OK, or hive_fail(code, text): that
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

/* Grows when something is added, never for less: what is here stays as it is as long as the library is libhive-c.so.0.
 */
#define HIVE_ABI_VERSION 5

/* --- errors --- */

typedef int32_t hive_code;
enum {
    HIVE_OK = 0,
    HIVE_INVALID_ARGUMENT = 1,  /* a value, a name, a handle or a call that can never be right */
    HIVE_NOT_FOUND = 2,         /* no such drone, input, output or parameter */
    HIVE_UNREACHABLE = 3,       /* nobody answers at that address */
    HIVE_CONNECTION_LOST = 4,   /* the peer ended or was cut off while something was under way */
    HIVE_TIMEOUT = 5,           /* the deadline passed before the answer came */
    HIVE_REFUSED = 6,           /* the drone understood and said no; the text gives its reason */
    HIVE_TYPE_MISMATCH = 7,     /* output and input speak different types; the text names both */
    HIVE_HALTED = 8,            /* the drone has halted and takes nothing until it is resumed */
    HIVE_LOCKED = 9,            /* another set is being decided there; it takes moments */
    HIVE_NAME_TAKEN = 10,       /* a living module has that name already */
    HIVE_NOT_PERMITTED = 11,    /* the peer or the user may not do this */
    HIVE_TOO_LARGE = 12,        /* over a limit */
    HIVE_MALFORMED = 13,        /* bytes or JSON that break the protocol */
    HIVE_VERSION_MISMATCH = 14, /* the peer speaks another version of the protocol */
    HIVE_UNSUPPORTED = 15,      /* a request that the module does not know */
    HIVE_FAILED = 16,           /* user code failed */
    HIVE_ABANDONED = 17,        /* every attempt at an event failed; it is given up */
    HIVE_STOPPED = 18,          /* the module is ending, or has ended */
    HIVE_IO = 19                /* the operating system refused */
};

/* What the last call that failed on this thread said; valid until the next one fails. */
HIVE_API hive_code hive_error_code(void);
HIVE_API const char* hive_error_text(void);
HIVE_API const char* hive_error_advice(void); /* what the caller can do about it */
/* For callbacks: keeps the text, and returns the code. HIVE_OK and unknown codes become HIVE_FAILED. */
HIVE_API hive_code hive_fail(hive_code code, const char* text);

/* Of a code: its name on the wire ("not_found"), what happened, what the caller can do, the exit code of a program that
   ends with it. HIVE_OK is "ok"; null for what is no code, and -1. */
HIVE_API const char* hive_code_token(hive_code code);
HIVE_API const char* hive_code_sentence(hive_code code);
HIVE_API const char* hive_code_advice(hive_code code);
HIVE_API int hive_code_exit_code(hive_code code);

HIVE_API const char* hive_version(void);  /* of Hive: "0.1.0" */
HIVE_API int hive_abi_version(void);      /* HIVE_ABI_VERSION of the library */
HIVE_API int hive_protocol_version(void); /* of what travels between modules */
/* Where drones of this machine meet: $HIVE_HOME, or $XDG_RUNTIME_DIR/hive, or /tmp/hive-UID. */
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
/* What the author of the sender put in, a JSON object; valid while the handle is. */
HIVE_API hive_code hive_event_header(const hive_event* event, const char** json, size_t* length);
/* The body; valid while the handle is. Empty in a notification. */
HIVE_API hive_code hive_event_bytes(const hive_event* event, const void** bytes, size_t* size);
/* The body with a life of its own: it holds memory of the sender, but no event. */
HIVE_API hive_code hive_event_body(const hive_event* event, hive_body** body);
/* While an event handle lives, the event counts as being worked on, and its sender waits with the next one. From here
   on it is only looked at. In a callback that takes effect when the callback has returned. */
HIVE_API hive_code hive_event_done(hive_event* event);

/* Bytes that never change, shared by all who hold them. From any thread. */
HIVE_API hive_code hive_body_new(const void* bytes, size_t size, hive_body** body); /* a copy */
/* Memory of the caller, unchanged until `free_bytes(user)` is called, on any thread. On failure it is not called. */
HIVE_API hive_code hive_body_over(const void* bytes, size_t size, void (*free_bytes)(void* user), void* user,
                                  hive_body** body);
HIVE_API hive_code hive_body_bytes(const hive_body* body, const void** bytes, size_t* size);
/* The bytes lie in memory of another process, which could still change them: copy before you check and use them. */
HIVE_API hive_code hive_body_foreign(const hive_body* body, bool* foreign);

/* A buffer to fill in place; see hive_output_loan(). */
HIVE_API hive_code hive_loan_bytes(const hive_loan* loan, void** bytes, size_t* size);
/* Its first `size` bytes as a body, once; from now on nobody writes to it, and the loan is only there to be released.
 */
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

/* A drone inside of a program that is more than a drone: it takes neither signals nor the process's end nor a log.
   `kind` says which program it is ("face"), `summary` what it does, in one sentence.
   Options: "name" in the swarm (default: the kind), "stateful" (keeps state between events, so its work cannot be
   shared), "parameters" {name: value} to begin with, "connect" ["image=camera.image,window=2"] (what it receives, as
   --connect of a program has it), "on_exception" "skip" or "halt", "halted" (from the start, until it is resumed),
   "listen" [addresses], "advertise" [addresses], "key" (the swarm's key file), "insecure",
   "no_announce", "remote_operator" (as the options of the command line); and what it may take: "signals" (SIGINT and
   SIGTERM end it), "ends_process" (when it was told to stop and its code does not return within 2 s). */
HIVE_API hive_code hive_drone_new(const char* kind, const char* summary, const char* options, hive_drone** drone);
/* A program that is a drone: reads the command line that all drones share (--name, --set, --describe, ...), writes its
   log to stderr, and takes signals and the process's end. Options: "stateful". When the line was answered (--help) or
   refused, *drone is null, and the program is to end with *exit_code. */
HIVE_API hive_code hive_drone_from_arguments(const char* kind, const char* summary, const char* options, int argc,
                                             const char* const* argv, hive_drone** drone, int* exit_code);
/* A program that is a drone and dies of SIGSEGV, SIGBUS, SIGILL, SIGFPE or SIGABRT writes its stack to its log. The
   runtime of another language writes its own stack to this file descriptor before it calls the handler that it has
   replaced: the trace begins with it. Standard error if this program traces no crash. After
   hive_drone_from_arguments(). */
HIVE_API int hive_stack_descriptor(void);
/* Takes the lines of the log of a drone made by hive_drone_new(), on any thread, until the drone is released. */
HIVE_API hive_code hive_drone_on_log(hive_drone* drone, hive_log_callback callback, void* user);
/* The same with the level of each line, in place of hive_drone_on_log(). */
HIVE_API hive_code hive_drone_on_leveled_log(hive_drone* drone, hive_leveled_log_callback callback, void* user);
HIVE_API hive_code hive_drone_name(const hive_drone* drone, char** name);

/* The value that a parameter will begin with: given by --set, or (*remembered) told before a crash, in which
   case --set may say the same once more. *json is null when it is its default. */
HIVE_API hive_code hive_drone_given(hive_drone* drone, const char* parameter, char** json, bool* remembered);
/* {"name", "type": "integer" | "number" | "flag" | "text", "default", "help"} and, if wanted, "least", "most" (both
   inclusive), "choices" [texts], "unit" ("px"), "operator" (it concerns the drone's machine, as a path or a login: over
   the network only members may set it, and only if the drone allows that). Read and written by hive_drone_values() and
   hive_drone_assign(). */
HIVE_API hive_code hive_drone_parameter(hive_drone* drone, const char* json);
/* The same, bound to a variable, whose present value is the default; a set changes it between two callbacks.
   `constraint`: {"least", "most", "choices", "unit", "operator"} or null. */
HIVE_API hive_code hive_drone_integer(hive_drone* drone, const char* name, int* variable, const char* constraint,
                                      const char* help);
HIVE_API hive_code hive_drone_number(hive_drone* drone, const char* name, double* variable, const char* constraint,
                                     const char* help);
HIVE_API hive_code hive_drone_flag(hive_drone* drone, const char* name, bool* variable, const char* constraint,
                                   const char* help);
/* The variable shows Hive's own text from here on; in on_change it may be let show another one. */
HIVE_API hive_code hive_drone_text(hive_drone* drone, const char* name, const char** variable, const char* constraint,
                                   const char* help);
/* What the variables of all parameters hold now: {name: value}. User thread. */
HIVE_API hive_code hive_drone_values(const hive_drone* drone, char** json, size_t* length);
/* Changes variables: in on_start or on_change, whose end is when the values are told. User thread. */
HIVE_API hive_code hive_drone_assign(hive_drone* drone, const char* json);

/* `type`: one media type or several ("image/jpeg,image/png"); the first is what is emitted unless it is said. */
HIVE_API hive_code hive_drone_output(hive_drone* drone, const char* name, const char* type, const char* help,
                                     hive_output** output);
/* The same for an output that gives its events in other encodings too, to receivers that ask for one, take nothing
   else, or are on another machine. `encodings`: [{"word": "jpeg", "type": "image/jpeg"}, ...], the preferred one first,
   which is what travels to other machines; with "least" and "most" a whole number may stand behind the word
   ("jpeg:80"). `type` lists the types of the encodings too. Emit the event as it is at hand. The callback gets it with
   the encoding that is wanted ("jpeg:80"), and answers by hive_encoded_give(). It comes on a thread of its own, beside
   those of the user thread, one at a time, once for all who want that encoding of an event. What it fails with is an
   exception of the drone, and the event travels as it was emitted. */
typedef hive_code (*hive_encode_callback)(void* user, const hive_event* event, const char* encoding,
                                          hive_encoded* encoded);
HIVE_API hive_code hive_drone_encoded_output(hive_drone* drone, const char* name, const char* type, const char* help,
                                             const char* encodings, hive_encode_callback callback, void* user,
                                             hive_output** output);
/* The event in that encoding: its body, and its header, null for that of the event. */
HIVE_API hive_code hive_encoded_give(hive_encoded* encoded, const char* header, size_t length, const hive_body* body);
HIVE_API hive_code hive_drone_on_event(hive_drone* drone, const char* input, const char* type, const char* help,
                                       hive_event_callback callback, void* user);
/* Inputs whose events belong together: [{"name", "type", "help"}, ...], two or more. `match`: null or {} for events of
   one capture, {"tolerance_us": N} for those nearest in time. The callback gets one event of each, in the order of the
   inputs. `check`, if there is one, looks at each event when it arrives. `matching` may be null. */
HIVE_API hive_code hive_drone_on_matched(hive_drone* drone, const char* inputs, const char* match,
                                         hive_set_callback callback, hive_event_callback check, void* user,
                                         hive_matching** matching);
HIVE_API hive_code hive_matching_rule(hive_matching* matching, const char* match);
/* After the parameters of one set were assigned, and once at the start. If it fails, the old values are put back, it is
   called again, and the set is refused with its text. */
HIVE_API hive_code hive_drone_on_change(hive_drone* drone, hive_callback callback, void* user);
/* Once, when the drone runs: the place to open devices. If it fails, the drone does not run. */
HIVE_API hive_code hive_drone_on_start(hive_drone* drone, hive_callback callback, void* user);
/* When everything that the inputs receive has come to its end and has been worked on, before the outputs end too.
   `text` says what is lacking, empty: nothing. Once more when something came after all. */
HIVE_API hive_code hive_drone_on_end(hive_drone* drone, hive_end_callback callback, void* user);
/* What a source does, again and again between callbacks; it says how long to wait before the next call. It is called
   earlier when the demand for an output changes, a parameter was set, or by hive_drone_wake(). */
HIVE_API hive_code hive_drone_main(hive_drone* drone, hive_main_callback callback, void* user);
/* What has been declared so far, as --describe prints it. */
HIVE_API hive_code hive_drone_describe(const hive_drone* drone, char** json, size_t* length);

/* --- a drone: running --- */

/* Until it is told to stop. For --describe it prints the interface instead. A drone runs once. */
HIVE_API hive_code hive_drone_run(hive_drone* drone);
/* The same in pieces: meet the swarm; work for about so long (at least 1 ms), until *goes_on is false; end, as the
   request `stop` would. */
HIVE_API hive_code hive_drone_start(hive_drone* drone);
HIVE_API hive_code hive_drone_step(hive_drone* drone, int64_t time_ms, bool* goes_on);
HIVE_API hive_code hive_drone_end(hive_drone* drone);

/* From any thread, once it runs. */
HIVE_API hive_code hive_drone_wake(hive_drone* drone); /* calls main as soon as possible */
HIVE_API hive_code hive_drone_stop(hive_drone* drone); /* ends it as the request `stop` would */
/* What state its world is in ("end of source"; "" or null: all is well), and in one word why nothing moves, null or one
   of the reasons of SPEC.md ("source_ended"). */
HIVE_API hive_code hive_drone_condition(hive_drone* drone, const char* text, const char* reason);
/* How many events the present source has in all; 0: unknown, or without end. */
HIVE_API hive_code hive_drone_source_events(hive_drone* drone, int64_t events);
/* An exception, without failing. */
HIVE_API hive_code hive_drone_report(hive_drone* drone, hive_code code, const char* text);
/* Writes a line to the log, at level "info". */
HIVE_API hive_code hive_drone_log(hive_drone* drone, const char* text);
/* The same at another level: "debug", "info", "warning" or "error". */
HIVE_API hive_code hive_drone_log_at(hive_drone* drone, const char* level, const char* text);
HIVE_API hive_code hive_drone_stopping(const hive_drone* drone, bool* stopping);
/* User thread: what an application would be told now, {"state", "events", "outputs", "inputs", ...}. */
HIVE_API hive_code hive_drone_status(hive_drone* drone, char** json, size_t* length);

/* Does anybody receive bodies, be it headers alone; does everybody ask for another one (sources on demand)? */
HIVE_API hive_code hive_output_wanted(const hive_output* output, bool* wanted);
HIVE_API hive_code hive_output_received(const hive_output* output, bool* received);
HIVE_API hive_code hive_output_asked(const hive_output* output, bool* asked);
/* A buffer of at most 64 MiB, the body of an event, that receivers on this machine read without a copy; never waits.
   More is HIVE_TOO_LARGE. From any thread. */
HIVE_API hive_code hive_output_loan(const hive_output* output, size_t size, hive_loan** loan);
/* Sends an event; never waits for a receiver. Inside a callback it inherits identity and time of the input, elsewhere
   it begins a new identity. `header`: a JSON object of `length` bytes, null for {}. `type`: null for the output's
   first. The bytes are copied. User thread, as all that follow. */
HIVE_API hive_code hive_output_emit(hive_output* output, const char* header, size_t length, const void* bytes,
                                    size_t size, const char* type);
/* The same with a body, which is not copied when it came of a loan. Null: without. */
HIVE_API hive_code hive_output_emit_body(hive_output* output, const char* header, size_t length, const hive_body* body,
                                         const char* type);
/* The same with a body that is made only if somebody is to have it: it is wanted, or it has to wait for the first
   receiver of what comes of a source on demand. `make` puts the handle of a body into its place, which is taken over;
   it is called before this returns, or not at all. What it fails with is what this fails with. */
typedef hive_code (*hive_body_callback)(void* user, hive_body** body);
HIVE_API hive_code hive_output_emit_made(hive_output* output, const char* header, size_t length,
                                         hive_body_callback make, void* user, const char* type);
/* Begins an identity captured at that time (microseconds since 1970). `lossless`: of a source on demand. A body
   need not be made when it is not wanted: see hive_output_emit_made(). */
HIVE_API hive_code hive_output_emit_captured(hive_output* output, int64_t captured_us, bool lossless,
                                             const char* header, size_t length, const hive_body* body,
                                             const char* type);
HIVE_API hive_code hive_output_emit_captured_made(hive_output* output, int64_t captured_us, bool lossless,
                                                  const char* header, size_t length, hive_body_callback make,
                                                  void* user, const char* type);
/* For main, about something that was taken and cannot be given, as a damaged file: it has its number all the same.
   Always fails, with that code; let main return it. */
HIVE_API hive_code hive_output_fail(hive_output* output, int64_t captured_us, bool lossless, hive_code code,
                                    const char* text);
/* Sends an event again as it once was, with its own identity. */
HIVE_API hive_code hive_output_repeat(hive_output* output, const hive_event* event);
/* The source has come to its end: nothing more will come, unless something is emitted all the same. Drones pass it on,
   so that whoever collects at the other end knows that it has everything. `text`: what is lacking ("87 of
   196 frames: the file is damaged"); null or "": nothing. */
HIVE_API hive_code hive_output_end(hive_output* output, const char* text);
/* What is captured from now on is of another source: it is numbered from 1. After an end that is so by itself; called
   all the same, it revokes the end at once, before the first event is made. */
HIVE_API hive_code hive_output_begin_source(hive_output* output);

/* --- an application --- */

/* Calls block until they are confirmed or their deadline has passed (HIVE_TIMEOUT). They may come from several threads,
   and then wait for one another. After hive_application_close(), and with collectors of a closed application, each is
   HIVE_STOPPED. An end of a connection is written "camera.image", or "camera" where only one port fits. What a key or a
   role does not allow is HIVE_NOT_PERMITTED.
   Options: "name" (default "app-PID"), "home" (default $HIVE_HOME, ...), "timeout_ms" (default 5000), "key" (the
   swarm's key file, for drones on other machines; default $HIVE_KEY, or ~/.config/hive/swarm.key). */
HIVE_API hive_code hive_application_new(const char* options, hive_application** application);
/* Leaves the swarm; waits for calls of other threads that are under way. Once more: nothing. */
HIVE_API hive_code hive_application_close(hive_application* application);
HIVE_API hive_code hive_application_name(const hive_application* application, char** name);
HIVE_API hive_code hive_application_timeout(hive_application* application, int64_t timeout_ms);

/* ["camera", ...]: the drones that run here, and those on other machines that are known; those that crashed and are
   remembered; those that fit a glob or a name (HIVE_NOT_FOUND when none does). */
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
/* Where a drone is met: {"drone", "host" ("local": this machine), "address", "ssh", "answered_us"}. A drone is called
   "NAME@HOST" where several have the same name. */
HIVE_API hive_code hive_application_place(hive_application* application, const char* drone, char** json,
                                          size_t* length);
/* The list of places: what this home was told of drones on other machines. [{"drone", ...}, ...] */
HIVE_API hive_code hive_application_places(hive_application* application, char** json, size_t* length);
/* Writes a place into the list: {"drone", "host", "address": "tcp://HOST:PORT", "ssh"}. */
HIVE_API hive_code hive_application_add_place(hive_application* application, const char* place);
/* Strikes the place of a drone off the list, as hive_application_places() gives it. HIVE_NOT_FOUND: it was not there.
 */
HIVE_API hive_code hive_application_forget_place(hive_application* application, const char* place);
/* Returns when the drone is "running" (it answers, and its start is over), "idle", "halted" or "gone". */
HIVE_API hive_code hive_application_wait(hive_application* application, const char* drone, const char* state,
                                         int64_t timeout_ms);

/* Options: "transfer" "sync" | "stream", "delivery" "data" | "notify", "window" 1 to 64, "group", "first_frame",
   "lease_ms", "encoding". *ends: {"sender": "camera.image", "receiver": "face.image"}; may be null. */
HIVE_API hive_code hive_application_connect(hive_application* application, const char* sender, const char* receiver,
                                            const char* options, char** ends);
HIVE_API hive_code hive_application_disconnect(hive_application* application, const char* sender, const char* receiver);

/* Sets {name: value}, all or none. *applied, if not null: what the drone made of them. */
HIVE_API hive_code hive_application_set(hive_application* application, const char* drone, const char* parameters,
                                        char** applied);
/* On all of ["face-1", ...] or on none. *result: {"changed": "all" | "none" | "unclear", "answers": [{"drone",
   "result"} or {"drone", "error": {"code", "text", "advice"}}, ...]}. HIVE_OK says only that it was tried. `cancelled`,
   if there is one, is asked now and then; what it returns but HIVE_OK cancels. */
HIVE_API hive_code hive_application_set_all(hive_application* application, const char* drones, const char* parameters,
                                            hive_callback cancelled, void* user, char** result);
/* `names`: ["scale", ...], null for all. */
HIVE_API hive_code hive_application_get(hive_application* application, const char* drone, const char* names,
                                        char** values);
/* *answers as in set_all. */
HIVE_API hive_code hive_application_get_all(hive_application* application, const char* drones, const char* names,
                                            char** answers);

/* Receives from ["face.faces", ...]. Options: "connection" {as for connect; "window" 64}, "ordered", "patience_ms". */
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
   program hive-KIND in $HIVE_DRONE_PATH or $PATH, or a Python file. Options: "name" (default: the kind), "ssh" (another
   machine, as ssh knows it), "parameters" {name: value}, "ready_ms" (default 10000), "if_missing" (a drone of this name
   and kind that runs there already is left as it is, and counts as started), and as in a swarm file "on_exception",
   "halted", "listen", "advertise", "key", "insecure", "no_announce", "remote_operator", "log_level". *place, if not
   null: as of hive_application_place(). HIVE_NAME_TAKEN when a drone has the name; when it exits instead, the code that
   has its exit code, or HIVE_FAILED, with the last lines of its log. */
HIVE_API hive_code hive_application_start(hive_application* application, const char* kind, const char* options,
                                          char** place);
/* A new process takes over from a running drone: its name, places, parameters and connections pass over when it is
   ready. Options as of hive_application_start(), without "name", "ssh" and "if_missing", and "kind" (default: what the
   old one is), "lose_state" (the old one may lose what it remembers of earlier events); what is not given is as it was.
   Until the new one is ready, an error or a cancellation leaves the old one as it was; then it goes on by itself. */
HIVE_API hive_code hive_application_replace(hive_application* application, const char* drone, const char* options,
                                            char** place);
/* Why nothing comes from ["face", "face.faces", ...]; of []: from any drone. {"text": one line; "" when nothing holds
   them up, "causes": [{"what": "halted", "drone", "connection", "text", "evidence", "command", "blocks"}], those that
   block first, and of these the one nearest to the source, "flows": [{"drone", "received_per_s", "emitted_per_s",
   "age_us"}]}. Looks twice, 300 ms apart. */
HIVE_API hive_code hive_application_explain(hive_application* application, const char* outputs, char** json,
                                            size_t* length);
/* Where the time of events goes, and what would help: {"goal", "lines": [{"from", "to", "per_s", "latency_us",
   "stations":
   [{"what", "at", "time_us", "max_per_s"}], "limits": the same, the bottleneck first, "proposals": [{"what", "text",
   "command", "predicted_per_s", "predicted_us", "next", "sure", "unsure"}], the best first}]}, as hivectl advise --help
   explains. `drones`: ["face"], or the first and the last drone of a line; []: all lines. Options: {"goal": "fps"
   (default) or "latency", "time_ms": how long to measure, default 2000}. */
HIVE_API hive_code hive_application_advise(hive_application* application, const char* drones, const char* options,
                                           char** json, size_t* length);
/* Whether anything was lost: {"clean": false if it was, "connections": [{"from", "to", "state", "came", a count for
   each fate, "in_flight", "received", "processed", "lost", "fates": a text, "losses": [{"fate", "at", "events",
   "promised"}], "differences": [text], "verdict": "ok", "lost" or "differs"}], "silent": [drones that did not answer]}.
   A count is null if its end did not answer. Asks all drones three times. */
HIVE_API hive_code hive_application_audit(hive_application* application, char** json, size_t* length);
/* What the swarm is made of: {"drones": [{"name", "host", "kind", "state"}], "connections": [{"from", "to", "group",
   "connected"}]}. "host" is "local" for this machine, and "" for an application; "state" is "silent" if a drone did not
   answer. */
HIVE_API hive_code hive_application_graph(hive_application* application, char** json, size_t* length);
/* What a drone failed at, as far as it is kept on this machine, by number: [{"drone", "number", "time_us", "code",
   "text", "inputs": [{"input", "sender", "type", "size", "source", "epoch", "seq", "header"}]}]. "code" is that of an
   error, or "died", "silent" (cut off) or "late" (held it beyond its lease). The drone need not run. */
HIVE_API hive_code hive_application_failures(hive_application* application, const char* drone, char** json,
                                             size_t* length);
/* Gives the inputs of a failure to a fresh drone of the same kind, apart from the swarm: {"outcome": "passed", "threw",
   "died" or "hung", "code", "text", "emitted", "log"}. `number` 0: the newest. Options: {"kind", "program": of another
   build, "parameters": beside those that the drone was given, "under": ["valgrind"], "limit_ms": default 30000}. For
   the main thread, at whose end the fresh drone ends. */
HIVE_API hive_code hive_application_rerun(hive_application* application, const char* drone, int64_t number,
                                          const char* options, char** json, size_t* length);
HIVE_API hive_code hive_application_halt(hive_application* application, const char* drone);
HIVE_API hive_code hive_application_resume(hive_application* application, const char* drone);
HIVE_API hive_code hive_application_stop(hive_application* application, const char* drone);
/* "skip" or "halt": what happens when its code throws. */
HIVE_API hive_code hive_application_exception_policy(hive_application* application, const char* drone,
                                                     const char* policy);

/* For this thread: asked again and again while a call of an application or a collector waits, on any of them. What
   `callback` returns but HIVE_OK ends the call with HIVE_STOPPED; whether it has had its effect nobody knows then. It
   must not call that application. Null: nobody is asked. */
HIVE_API hive_code hive_on_wait(hive_callback callback, void* user);

/* The next event; *event is null when none came within the time, and at once when everything has ended. */
HIVE_API hive_code hive_collector_next(hive_collector* collector, int64_t timeout_ms, hive_event** event);
/* Of a collector of sets: fills events[0] to events[*count - 1]; *count is 0 when none was complete within the time,
   and at once when everything has ended. HIVE_TOO_LARGE when a set has more events than `capacity`. */
HIVE_API hive_code hive_collector_next_set(hive_collector* collector, int64_t timeout_ms, hive_event** events,
                                           size_t capacity, size_t* count);
/* {"received", "duplicates", "missing", "missing_turns", "failed", "dropped"}, and of sets "sets": {"sets", "waiting",
   "unmatched", "duplicates", "missing"}. */
HIVE_API hive_code hive_collector_counts(hive_collector* collector, char** json, size_t* length);
/* One of these without JSON: "received", "duplicates", "missing", "failed", "dropped", or of sets "sets", "waiting",
   "unmatched". */
HIVE_API hive_code hive_collector_count(hive_collector* collector, const char* counter, int64_t* value);
/* This end of each connection, as a drone's status has it (SPEC.md, section 6.4): [{"input", "from" ("camera.image"),
   "connected", "received", "queued", "last_age_us", "error", "why", ...}]; what is 0, false or empty is left out. */
HIVE_API hive_code hive_collector_inputs(hive_collector* collector, char** json, size_t* length);
/* Has all that it receives come to its end, and was everything taken? Then *text, if not null, says what is
   lacking, "" when nothing is. It is so no longer when something comes after all. */
HIVE_API hive_code hive_collector_ended(hive_collector* collector, bool* ended, char** text);
/* Ends receiving; the handle stays, for its counts no longer. Once more: nothing. */
HIVE_API hive_code hive_collector_close(hive_collector* collector);

#ifdef __cplusplus
}
#endif

#endif
