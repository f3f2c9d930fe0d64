// Finds the causes that block drones in their statuses. Queries no drone, reads no clock.
#pragma once

#include "look.hpp"

#include <hive/explain.hpp>

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace hive::explaining {

class Search {
public:
    /// @param earlier  an earlier look; null: causes that only a difference shows are assumed possible
    /// @param self     the name of the application itself, which blocks no drone
    Search(const Look& look, const Look* earlier, const Absent& absent, std::string self)
        : look_(look), earlier_(earlier), absent_(absent), self_(std::move(self))
    {
    }

    /// Finds what blocks the outputs of a drone. @param port  one of them; empty: all
    void target(const std::string& drone, const std::string& port);
    /// Finds what blocks the events from one drone to another.
    void connection(const Endpoint& sender, const Endpoint& receiver);

    /// The one nearest to the source first.
    [[nodiscard]] const std::vector<Cause>& causes() const { return causes_; }
    /// Drones on the path that answer, sources first.
    [[nodiscard]] const std::vector<std::string>& passed() const { return passed_; }

private:
    /// An output that waits for a receiver.
    struct Wait {
        std::string end;  ///< "camera.image"
        const EdgeStatus& edge;
        std::int64_t quiet;  ///< microseconds
        [[nodiscard]] std::string text() const;
    };

    /// A connection with the rows of both ends; false: its sender has no row.
    struct Link {
        const StatusAnswer *receiver, *sender;
        std::string from, to;  ///< "camera.image", "face.image"
        const EdgeStatus* edge = nullptr;
        const EdgeStatus* earlier = nullptr;  ///< at the look before
        bool first_look = false;

        explicit operator bool() const { return edge != nullptr; }
        /// Has the count grown since the earlier look? True at the first look.
        template <class Count>
        [[nodiscard]] bool grew(Count count) const
        {
            return first_look || (earlier && std::invoke(count, *edge) > std::invoke(count, *earlier));
        }
    };

    /// Examines the drone's senders, then the drone. @return whether a cause was found
    /// @param evidence  if the drone does not answer
    bool above(const std::string& drone, const Endpoint* only = nullptr, const std::string& evidence = {});
    /// Examines one input, from its sender on.
    void link(const StatusAnswer& receiver, const InputStatus& input);
    void silent(const StatusAnswer& answer, const std::string& evidence);
    void not_running(const std::string& drone, const std::string& text, const std::string& evidence);
    /// How to start a drone that does not run, on the machine where it ran.
    struct Start {
        std::string command{};  ///< empty: its kind is not known, or how to reach its machine
        std::string at{};       ///< its last address, if that was on another machine: "tcp://cam1:7700"
        std::string there{};    ///< the command on that machine; empty: its kind is not known
    };
    [[nodiscard]] Start start_of(const std::string& drone) const;
    [[nodiscard]] static std::string where_text(const Start& start);
    /// The same for one that was on another machine, from the status of a receiver; nothing: it was on this machine.
    [[nodiscard]] std::optional<Start> start_elsewhere(const std::string& drone) const;
    /// For a process that answers no request. @param otherwise  the command if its process or kind is not known
    [[nodiscard]] std::string restart(const std::string& drone, const std::string& otherwise) const;
    /// How long ago receivers lost it: "worker.image lost it 12 s ago"; empty: not known.
    [[nodiscard]] std::string lost_text(const std::string& drone) const;
    /// Examines the drone's own status. @return whether it has a cause
    /// @param awaited  a sender waits for it, so it is still connected
    bool own(const StatusAnswer& answer, bool awaited = false);
    bool throws(const StatusAnswer& answer);
    bool stuck(const StatusAnswer& answer);
    void unconnected(const StatusAnswer& answer, const InputStatus& input);
    [[nodiscard]] Link link_at(const StatusAnswer& receiver, const InputStatus& input) const;
    /// A cause that only slows down.
    void slower(Cause::What what, const Link& link, const std::string& text, const std::string& evidence,
                const std::string& command);
    void narrow(const StatusAnswer& answer, const InputStatus& input);
    void dropping(const StatusAnswer& answer, const InputStatus& input);
    void copied(const StatusAnswer& answer, const InputStatus& input);
    void encoded(const StatusAnswer& answer, const InputStatus& input);
    /// Examines what stalled outputs wait for. @return whether a cause is known, found now or before
    bool outputs(const StatusAnswer& answer, const std::string& port);
    /// For a running source without receivers.
    void unreceived(const StatusAnswer& answer);
    void quiet(const StatusAnswer& answer, const std::string& port);
    bool waits(const StatusAnswer& answer, const OutputStatus& output);
    /// Finds why receivers do not accept waiting events. @return as outputs()
    bool below(const StatusAnswer& sender, const OutputStatus& output);
    bool below(const StatusAnswer& sender, const OutputStatus& output, const EdgeStatus& edge);
    [[nodiscard]] bool may_be_started(const std::string& drone, const StatusAnswer& sender) const;
    void missing_receiver(const StatusAnswer& sender, const Wait& wait);
    void receiver(const StatusAnswer& answer, const Wait& wait);
    [[nodiscard]] static bool is_under_way(const StatusAnswer& receiver, const EdgeStatus& edge);
    Cause& receiver_cause(const StatusAnswer& answer, const Wait& wait);
    Cause& slow(const StatusAnswer& answer, const std::string& evidence);

    /// Adds a cause, once per kind, drone and text.
    Cause& add(Cause::What what, const std::string& drone, const std::string& text, const std::string& evidence = {},
               const std::string& command = {});
    /// The status of the drone at the earlier look, if it is the same run.
    [[nodiscard]] const Status* before(const StatusAnswer& answer) const;
    /// Has it emitted or processed anything since the earlier look?
    [[nodiscard]] bool moves(const StatusAnswer& answer) const;

    const Look& look_;
    const Look* earlier_;
    const Absent& absent_;
    std::string self_;
    std::set<std::string> seen_;
    std::map<std::string, bool> waited_for_;  ///< receivers; true: examined, so their causes are known
    std::vector<std::string> passed_;
    std::vector<Cause> causes_;
};

/// Events that its code has processed, with success or not.
std::int64_t processed(const Status& status, std::int64_t InputStatus::*count);
/// Age of an output's newest event, by the drone's own clock; without one, since the drone started.
std::int64_t quiet_us(const Status& status, const OutputStatus& output);
/// Processing time of one event; 0: not known yet.
std::int64_t work_us(const Status& status);
/// ", 99 % within 52 ms", of the slowest input; empty: not known yet.
std::string p99_text(const Status& status);
/// Can a text of a peer be in a command, since a shell takes no character of it for anything else?
bool is_plain(const std::string& text);
/// "hivectl ps" in an advice such as "see what runs: hivectl ps"; empty: none.
std::string command_in(const std::string& advice);
/// Events emitted by all outputs, without exceptions.
std::int64_t emitted(const Status& status);

}  // namespace hive::explaining
