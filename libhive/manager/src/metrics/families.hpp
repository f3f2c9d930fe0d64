// The families, as libhive/docs/metrics.md lists them.
#pragma once

#include "book.hpp"

namespace hive::measuring {

using enum MetricFamily::Type;

// --- of drones ---
inline constexpr Described drone_up{"hive_drone_up", gauge, "", "1 if the drone answers, 0 if it does not or crashed."};
inline constexpr Described drone{"hive_drone", info, "", "What the drone is, and where it runs."};
inline constexpr Described drone_state{"hive_drone_state", state, "", "What the drone is doing.", true};
inline constexpr Described drone_start{"hive_drone_start_time_seconds", gauge, "seconds",
                                       "When the drone started, by the clock of its machine.", true};
inline constexpr Described drone_busy{"hive_drone_busy_seconds", counter, "seconds",
                                      "Time for which the drone's code has been working."};
inline constexpr Described drone_encoding{"hive_drone_encoding_seconds", counter, "seconds",
                                          "Time for which the drone has been encoding events for receivers."};
inline constexpr Described drone_cpu{"hive_drone_cpu_seconds", counter, "seconds",
                                     "Processor time of the drone's process."};
inline constexpr Described drone_memory{"hive_drone_memory_bytes", gauge, "bytes",
                                        "Memory that the drone's process has in use."};
inline constexpr Described drone_exceptions{"hive_drone_exceptions", counter, "", "Exceptions of the drone's code."};
inline constexpr Described drone_condition{
    "hive_drone_condition", gauge, "",
    "1 if the drone reports a condition other than the end of its source; hivectl ps prints it.", true};

// --- of outputs ---
inline constexpr Described emitted{"hive_output_emitted_events", counter, "events", "Events emitted."};
inline constexpr Described unreceived{"hive_output_unreceived_events", counter, "events",
                                      "Of those emitted: events that the output had no receiver for."};
inline constexpr Described last_emitted{"hive_output_last_event_time_seconds", gauge, "seconds",
                                        "When the newest event was emitted, by the clock of its machine.", true};
inline constexpr Described stalled{"hive_output_stalled", gauge, "",
                                   "1 if the output has emitted nothing for a second; hivectl explain says why.", true};
inline constexpr Described applications{"hive_output_applications", gauge, "",
                                        "Applications that receive the output, such as hivectl results."};

// --- of connections, by their senders ---
inline constexpr Described connected{"hive_connection_connected", gauge, "",
                                     "1 if the receiver is registered, 0 if it is gone.", true};
inline constexpr Described came{"hive_connection_came_events", counter, "events",
                                "Events for the receiver: the sum of those settled and in flight."};
inline constexpr Described settled{"hive_connection_settled_events", counter, "events",
                                   "What became of the events for the receiver."};
inline constexpr Described in_flight{"hive_connection_in_flight_events", gauge, "events",
                                     "Events for the receiver whose fate is open."};
inline constexpr Described waiting{"hive_connection_waiting_events", gauge, "events",
                                   "Of those in flight: events that have not been sent."};
inline constexpr Described window{"hive_connection_window_events", gauge, "events",
                                  "Events that the receiver requests ahead."};
inline constexpr Described shared{"hive_connection_shared_bodies", counter, "bodies",
                                  "Bodies that went through shared memory."};
inline constexpr Described fallback{"hive_connection_fallback_bodies", counter, "bodies",
                                    "Bodies that shared memory refused, and that were copied."};

// --- of connections, by their receivers ---
inline constexpr Described age{"hive_connection_age_seconds", gauge, "seconds",
                               "From the capture of the newest event to its arrival at the receiver.", true};
inline constexpr Described round_trip{"hive_connection_round_trip_seconds", gauge, "seconds",
                                      "Shortest recent round trip to a sender on another machine.", true};
inline constexpr Described clock_offset{"hive_connection_clock_offset_seconds", gauge, "seconds",
                                        "Clock of a sender on another machine minus that of the receiver.", true};

// --- of groups that share work, by their senders ---
inline constexpr Described group_members{"hive_group_members", gauge, "", "Members that are registered."};
inline constexpr Described group_came{"hive_group_came_events", counter, "events",
                                      "Events for the group: the sum of those settled and in flight."};
inline constexpr Described group_settled{"hive_group_settled_events", counter, "events",
                                         "What became of the events for the group."};
inline constexpr Described group_in_flight{"hive_group_in_flight_events", gauge, "events",
                                           "Events for the group whose fate is open."};

// --- of inputs, by their drones, with connections that have ended ---
inline constexpr Described received{"hive_input_received_events", counter, "events",
                                    "Events received: the sum of those settled, queued and in progress."};
inline constexpr Described input_settled{"hive_input_settled_events", counter, "events",
                                         "What became of the events received."};
inline constexpr Described queued{"hive_input_queued_events", gauge, "events",
                                  "Events that wait for the drone's code."};
inline constexpr Described in_progress{"hive_input_in_progress_events", gauge, "events",
                                       "Events that the drone's code works on."};

// --- of both ends ---
inline constexpr Described audit_lost{
    "hive_audit_lost_events", counter, "events",
    "Events lost although no option allowed it, as hivectl audit counts them, but for those of applications."};

inline constexpr Described scrape_duration{"hive_scrape_duration_seconds", gauge, "seconds",
                                           "How long it took to query all drones."};

}  // namespace hive::measuring
