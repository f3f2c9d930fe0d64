// Statuses as lines of text.
#include "picture.hpp"

#include <utility>

namespace hive::mixtures {
namespace {

void add(std::string& text, std::string_view name, std::int64_t count)
{
    if (count != 0)
        text += ", " + std::string(name) + " " + std::to_string(count);
}

std::string state_of(bool connected, Reason why)
{
    return std::string(connected ? "" : ", not connected") + (why == Reason::none ? "" : ", ")
           + std::string(token(why));
}

}  // namespace

std::string to_text(const EdgeStatus& edge)
{
    std::string text = "came " + std::to_string(edge.events.total());
    for (std::size_t i = 0; i < fates; ++i)
        add(text, token(static_cast<Fate>(i)), edge.events.of(static_cast<Fate>(i)));
    add(text, "in flight", edge.events.in_flight());
    add(text, "of these waiting", edge.waiting);
    return text + state_of(edge.connected || edge.group, edge.why);
}

std::string to_text(const InputStatus& input)
{
    std::string text = "received " + std::to_string(input.received);
    add(text, "processed", input.processed);
    add(text, "abandoned", input.abandoned);
    add(text, "duplicates", input.duplicates);
    add(text, "discarded", input.discarded);
    add(text, "dropped", input.dropped);
    add(text, "unmatched", input.unmatched);
    add(text, "queued", input.queued);
    add(text, "in hand", input.in_hand);
    return text + state_of(input.connected, input.why);
}

std::string picture(const Statuses& statuses)
{
    std::string text;
    for (const auto& [name, status] : statuses) {
        text += name + " (epoch " + std::to_string(status.epoch) + ")" + state_of(true, status.why) + "\n";
        for (const auto& output : status.outputs) {
            text += "  " + output.name + ": produced " + std::to_string(output.produced);
            add(text, "unreceived", output.unreceived);
            text += state_of(true, output.why) + "\n";
            for (const auto& edge : output.edges)
                text += "    -> " + edge.receiver + ": " + to_text(edge) + "\n";
        }
        for (const auto* inputs : {&status.inputs, &status.left})
            for (const auto& input : *inputs)
                text += "  " + input.input + " <- " + input.from + ": " + to_text(input) + "\n";
    }
    return text;
}

namespace {

class Bytes {
public:
    void add(const std::string& name) { (text_ += name) += '\n'; }
    void add(std::int64_t number) { text_.append(reinterpret_cast<const char*>(&number), sizeof number); }
    void add(Reason why) { text_ += static_cast<char>(why); }
    void add(bool connected) { text_ += connected ? '1' : '0'; }
    void add(const EdgeStatus& edge)
    {
        add(edge.receiver);
        for (std::size_t i = 0; i < fates; ++i)
            add(edge.events.of(static_cast<Fate>(i)));
        for (const auto count : {edge.events.total(), edge.events.in_flight(), edge.waiting})
            add(count);
        add(edge.connected || edge.group);
        add(edge.why);
    }
    void add(const InputStatus& input)
    {
        add(input.input);
        add(input.from);
        for (const auto count : {input.received, input.processed, input.abandoned, input.duplicates, input.discarded,
                                 input.dropped, input.unmatched, input.queued, input.in_hand})
            add(count);
        add(input.connected);
        add(input.why);
    }
    void add(const OutputStatus& output)
    {
        add(output.name);
        add(output.produced);
        add(output.unreceived);
        add(output.why);
        for (const auto& edge : output.edges)
            add(edge);
    }
    std::string take() { return std::move(text_); }

private:
    std::string text_;
};

}  // namespace

std::string fingerprint(const Statuses& statuses)
{
    Bytes bytes;
    for (const auto& [name, status] : statuses) {
        bytes.add(name);
        bytes.add(status.epoch);
        bytes.add(status.why);
        for (const auto& output : status.outputs)
            bytes.add(output);
        for (const auto* inputs : {&status.inputs, &status.left})
            for (const auto& input : *inputs)
                bytes.add(input);
    }
    return bytes.take();
}

}  // namespace hive::mixtures
