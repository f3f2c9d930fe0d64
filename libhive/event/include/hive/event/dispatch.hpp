// Sends each receiver its events in its encoding and in the order of the decisions, while some of them are still being
// encoded.
#pragma once

#include <hive/encoder.hpp>
#include <hive/error.hpp>
#include <hive/event/decisions.hpp>

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace hive::event {

/// Network side. An event is encoded at most once for each encoding, however many receivers get it, and only after the
/// decision that one of them does. A waiting entry holds the event, and with it the ticket of a lossless cause.
class Dispatch {
public:
    using Run = std::function<void(std::function<void()>)>;

    struct Hooks {
        /// Sends an event as `form`, which is the event itself or a rendition of it.
        std::function<void(const Send& send, const Emission& form)> transmit;
        /// The encoder threw; the event is sent unencoded.
        std::function<void(const EmissionPtr& event, const Error& problem)> not_encoded;
        std::function<void(ReceiverId for_whom, std::function<void()>)> on_encoder_thread;
        Run on_network_side;
        /// Tells a receiver, after its events, whether anything more will come.
        std::function<void(ReceiverId receiver)> end = [](ReceiverId) {};
    };

    /// `encoder` is kept by reference, even by jobs: both outlive the encoder thread.
    Dispatch(const Encoder& encoder, Hooks hooks) : encoder_(encoder), hooks_(std::move(hooks)) {}

    /// @param encoding  empty: unencoded
    void send(const Send& send, const std::string& encoding);
    /// Queues the message whether anything more will come.
    void end(ReceiverId receiver);
    /// The receiver is gone: drops its waiting events, which are not encoded for it.
    void forget(ReceiverId receiver) { lines_.erase(receiver); }

private:
    struct Waiting {
        Send send;         ///< without event: the end
        EmissionPtr form;  ///< null while it is being encoded

        [[nodiscard]] bool ready() const { return form || !send.event; }
    };
    /// The outcome of a job.
    struct Made {
        EmissionPtr form;
        std::optional<Error> problem;  ///< why the event is sent unencoded
    };
    void encode(const std::shared_ptr<Waiting>& waiting, const std::string& encoding);
    [[nodiscard]] Made make(const EmissionPtr& event, const std::string& encoding) const;
    void made(const std::weak_ptr<Waiting>& waiting, const EmissionPtr& event, const Made& made);
    void advance(ReceiverId receiver);

    const Encoder& encoder_;
    Hooks hooks_;
    std::map<ReceiverId, std::deque<std::shared_ptr<Waiting>>> lines_;
    std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace hive::event
