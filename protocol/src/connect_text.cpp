// Reads and writes a connection as one argument.
#include <hive/connection_option.hpp>
#include <hive/error.hpp>
#include <hive/name.hpp>
#include <hive/protocol/connect_text.hpp>

#include <algorithm>
#include <functional>
#include <set>
#include <sstream>

namespace hive::protocol {
namespace {

constexpr const char* form = "write [INPUT=]DRONE.OUTPUT[,OPTION...], for example image=camera.image,window=2";

Error mistake(const std::string& text, const std::string& advice = form)
{
    return {Errc::invalid_argument, text, advice};
}

void read_option(Connect& connect, std::set<std::string, std::less<>>& seen, const std::string& word)
{
    const auto equals = word.find('=');
    const bool flag = equals == std::string::npos;
    const auto key = word.substr(0, equals);
    const auto table = connection_option_table();
    const auto option = std::ranges::find(table, key, &ConnectionOption::name);
    const bool special = key == "at" || key == "share";
    if (option == table.end() ? !special || (key == "share" && !flag) : option->is_flag() && !flag)
        throw mistake(in_quotes(word) + " is not an option", "there are " + connection_option_words());
    if (!seen.insert(key).second)
        throw mistake(key + " is given twice");
    const auto value = flag ? std::string() : word.substr(equals + 1);
    if (key == "share")
        return;
    if (option != table.end() && option->is_flag())
        static_cast<void>(option->set(connect.options, true));
    else if (value.empty())
        throw mistake(key + " needs a value: " + key + "=...");
    else if (key == "at")
        connect.address = value;
    else if (!option->set_text(connect.options, value))
        throw mistake(key + " must be " + std::string(option->must) + ", not " + in_quotes(value));
}

/// "image=camera.image": the input and the sender's output.
void read_ends(Connect& connect, const std::string& text)
{
    const auto equals = text.find('=');
    if (equals != std::string::npos)
        connect.input = require_name(text.substr(0, equals), "input");
    const auto sender = equals == std::string::npos ? text : text.substr(equals + 1);
    const auto dot = sender.rfind('.');
    if (dot == std::string::npos)
        throw mistake(in_quotes(sender) + " names no output, which is required here");
    connect.drone = require_name(sender.substr(0, dot), "drone");
    connect.output = require_name(sender.substr(dot + 1), "output");
}

}  // namespace

Connect connect_from_text(const std::string& text)
{
    Connect connect;
    std::istringstream words(text);
    std::string word;
    std::getline(words, word, ',');
    read_ends(connect, word);
    std::set<std::string, std::less<>> seen;
    while (std::getline(words, word, ','))
        read_option(connect, seen, word);
    if (text.ends_with(','))
        read_option(connect, seen, "");
    for (const auto& clash : connection_clashes())
        if (seen.contains(clash.one) && seen.contains(clash.other))
            throw mistake(std::string(clash.other) + " conflicts with " + std::string(clash.one));
    if (seen.contains("share") && connect.options.group.empty())
        connect.options.group = connect.drone;
    if (connect.options.lease && connect.options.group.empty())
        throw mistake("lease" + std::string(for_shared_work), "add share or group=NAME");
    return connect;
}

std::string to_text(const Connect& connect)
{
    std::ostringstream text;
    text << (connect.input.empty() ? "" : connect.input + "=") << connect.drone << '.' << connect.output;
    if (!connect.address.empty())
        text << ",at=" << connect.address;
    for (const auto& option : connection_option_table())
        if (option.is_given(connect.options))
            text << ',' << option.name << (option.is_flag() ? "" : "=" + option.text(connect.options));
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
