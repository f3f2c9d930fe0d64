// Reading and writing a connection as one word.
#include <hive/error.hpp>
#include <hive/name.hpp>
#include <hive/protocol/connect_text.hpp>

#include <charconv>
#include <cmath>
#include <set>
#include <sstream>

namespace hive::protocol {
namespace {

constexpr const char* form = "write [INPUT=]DRONE.OUTPUT[,OPTION...], for example image=camera.image,window=2";
constexpr const char* known_options = "at=ADDRESS, stream, notify, window=N, first_frame, share, group=NAME, "
                                      "lease=SECONDS and encoding=NAME";

Error mistake(const std::string& text, const std::string& advice = form)
{
    return {Errc::invalid_argument, text, advice};
}

/// The whole text as a number; nothing if it is none.
template <class Number>
std::optional<Number> number_in(const std::string& text)
{
    Number number{};
    const auto* end = text.data() + text.size();
    const auto [stop, problem] = std::from_chars(text.data(), end, number);
    return problem == std::errc() && stop == end ? std::optional(number) : std::nullopt;
}

int window_in(const std::string& text)
{
    const auto window = number_in<int>(text);
    if (!window || *window < 1 || *window > 64)
        throw mistake("window is a whole number from 1 to 64, not " + in_quotes(text));
    return *window;
}

std::chrono::milliseconds lease_in(const std::string& text)
{
    const auto seconds = number_in<double>(text);
    if (!seconds || !(*seconds >= 0.05 && *seconds <= 86'400))
        throw mistake("lease is a number of seconds from 0.05 to 86400, not " + in_quotes(text));
    return std::chrono::milliseconds(std::llround(*seconds * 1000));
}

void read_value(Connect& connect, const std::string& key, const std::string& value)
{
    auto& options = connect.options;
    if (value.empty())
        throw mistake(key + " needs a value: " + key + "=...");
    if (key == "at")
        connect.address = value;
    else if (key == "window")
        options.window = window_in(value);
    else if (key == "group")
        options.group = require_name(value, "group");
    else if (key == "lease")
        options.lease = lease_in(value);
    else
        options.encoding = value;
}

void read_flag(Connect& connect, const std::string& word)
{
    auto& options = connect.options;
    if (word == "stream")
        options.transfer = Transfer::streaming;
    else if (word == "notify")
        options.delivery = Delivery::notification;
    else if (word == "first_frame")
        options.first_frame = true;
    else if (options.group.empty())
        options.group = connect.drone;
}

void read_option(Connect& connect, std::set<std::string>& seen, const std::string& word)
{
    static const std::set<std::string> flags{"stream", "notify", "first_frame", "share"};
    static const std::set<std::string> keys{"at", "window", "group", "lease", "encoding"};
    const auto equals = word.find('=');
    const auto key = word.substr(0, equals);
    const bool flag = equals == std::string::npos && flags.contains(key);
    if (!flag && !keys.contains(key))
        throw mistake(in_quotes(word) + " is none of its options", std::string("there are ") + known_options);
    if (!seen.insert(key).second)
        throw mistake(key + " is given twice");
    if (flag)
        read_flag(connect, key);
    else
        read_value(connect, key, equals == std::string::npos ? "" : word.substr(equals + 1));
}

/// "image=camera.image": who sends, and to which input.
void read_ends(Connect& connect, const std::string& text)
{
    const auto equals = text.find('=');
    if (equals != std::string::npos)
        connect.input = require_name(text.substr(0, equals), "input");
    const auto sender = equals == std::string::npos ? text : text.substr(equals + 1);
    const auto dot = sender.rfind('.');
    if (dot == std::string::npos)
        throw mistake(in_quotes(sender) + " names no output: which ones a drone has is not known before it is there");
    connect.drone = require_name(sender.substr(0, dot), "drone");
    connect.output = require_name(sender.substr(dot + 1), "output");
}

/// As few digits as give the same number back.
std::string seconds_text(std::chrono::milliseconds duration)
{
    char text[32];
    const auto seconds = static_cast<double>(duration.count()) / 1000;
    return {text, std::to_chars(text, text + sizeof text, seconds, std::chars_format::fixed).ptr};
}

/// What goes together, as every other door checks it.
void require_sound(const ConnectionOptions& options, bool window_given)
{
    if (options.transfer == Transfer::streaming && window_given)
        throw mistake("a stream has no window");
    if (options.lease && options.group.empty())
        throw mistake("lease is for shared work", "add share or group=NAME");
    try {
        static_cast<void>(connection_options(to_json(options)));
    } catch (const Error& error) {
        throw mistake(error.what());
    }
}

}  // namespace

Connect connect_from_text(const std::string& text)
{
    Connect connect;
    std::istringstream words(text);
    std::string word;
    std::getline(words, word, ',');
    read_ends(connect, word);
    std::set<std::string> seen;
    while (std::getline(words, word, ','))
        read_option(connect, seen, word);
    if (text.ends_with(','))
        read_option(connect, seen, "");
    require_sound(connect.options, seen.contains("window"));
    return connect;
}

std::string to_text(const Connect& connect)
{
    const auto& options = connect.options;
    std::ostringstream text;
    text << (connect.input.empty() ? "" : connect.input + "=") << connect.drone << '.' << connect.output;
    if (!connect.address.empty())
        text << ",at=" << connect.address;
    if (options.transfer == Transfer::streaming)
        text << ",stream";
    else if (options.window != 1)
        text << ",window=" << options.window;
    if (options.delivery == Delivery::notification)
        text << ",notify";
    if (options.first_frame)
        text << ",first_frame";
    if (!options.group.empty())
        text << ",group=" << options.group;
    if (options.lease)
        text << ",lease=" << seconds_text(*options.lease);
    if (!options.encoding.empty())
        text << ",encoding=" << options.encoding;
    return text.str();
}

Expect expect_from_text(const std::string& text)
{
    const std::string advice = "write [OUTPUT=]DRONE.INPUT[,group=NAME], for example image=face.image";
    const auto comma = text.find(',');
    const auto ends = text.substr(0, comma);
    const auto equals = ends.find('=');
    Expect expect{.output = equals == std::string::npos ? "" : require_name(ends.substr(0, equals), "output"),
                  .receiver = equals == std::string::npos ? ends : ends.substr(equals + 1)};
    const auto dot = expect.receiver.rfind('.');
    if (dot == std::string::npos)
        throw mistake(in_quotes(expect.receiver) + " names no input", advice);
    require_name(expect.receiver.substr(0, dot), "drone");
    require_name(expect.receiver.substr(dot + 1), "input");
    if (comma == std::string::npos)
        return expect;
    constexpr std::string_view group = "group=";
    const auto option = text.substr(comma + 1);
    if (!option.starts_with(group))
        throw mistake("unknown option " + in_quotes(option), advice);
    expect.group = require_name(option.substr(group.size()), "group");
    return expect;
}

std::string to_text(const Expect& expect)
{
    return (expect.output.empty() ? "" : expect.output + "=") + expect.receiver
           + (expect.group.empty() ? "" : ",group=" + expect.group);
}

}  // namespace hive::protocol
