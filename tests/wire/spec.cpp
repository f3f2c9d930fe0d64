// SPEC.md against the code: its tables, its limits, its bytes.
#include "packet_reader.hpp"
#include "vectors.hpp"

#include <hive/interface.hpp>
#include <hive/protocol/messages.hpp>
#include <hive/status.hpp>

#include <map>
#include <set>
#include <sstream>

namespace hive::wire {
namespace {

using Cells = std::vector<std::string>;

std::string trimmed(const std::string& text)
{
    const auto first = text.find_first_not_of(" `");
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" `") - first + 1);
}

/// The rows of the table whose first line is `heading`, as cells without spaces and back-ticks around them.
std::vector<Cells> table(const std::string& heading)
{
    std::istringstream lines(read_file("SPEC.md"));
    std::string line;
    while (std::getline(lines, line) && line != heading) {
    }
    REQUIRE_MESSAGE(line == heading, heading);
    std::getline(lines, line);
    std::vector<Cells> rows;
    while (std::getline(lines, line) && line.starts_with('|')) {
        Cells cells;
        std::istringstream parts(line.substr(1));
        for (std::string cell; std::getline(parts, cell, '|');)
            cells.push_back(trimmed(cell));
        rows.push_back(cells);
    }
    return rows;
}

/// The words of one row of section 1.
std::set<std::string> words(const std::string& set)
{
    for (const auto& row : table("| set | words |"))
        if (row.at(0) == set) {
            std::set<std::string> result;
            std::istringstream list(row.at(1));
            for (std::string word; list >> word;)
                result.insert(trimmed(word));
            return result;
        }
    return {};
}

std::string limit(const std::string& what)
{
    for (const auto& row : table("| what | limit | beyond it |"))
        if (row.at(0) == what)
            return row.at(1).substr(0, row.at(1).find_first_not_of("0123456789"));
    return "no row " + what;
}

/// The bytes of the fenced blocks marked `hex`; what follows `|` on a line is for people.
std::vector<std::string> hex_blocks()
{
    std::istringstream lines(read_file("SPEC.md"));
    std::vector<std::string> blocks;
    bool inside = false;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("```")) {
            inside = line == "```hex";
            if (inside)
                blocks.emplace_back();
        } else if (inside) {
            line = line.substr(0, line.find('|'));
            std::erase(line, ' ');
            blocks.back() += from_hex(line);
        }
    }
    return blocks;
}

}  // namespace

TEST_CASE("SPEC: the table of packet types is the code's, both ways")
{
    std::map<int, std::string> in_spec, in_code;
    for (const auto& row : table("| type | token | channel | from → to | answered by |"))
        in_spec[std::stoi(row.at(0))] = row.at(1);
    for (int number = 0; number < 256; ++number)
        if (const auto name = protocol::token(static_cast<protocol::PacketType>(number)); !name.empty())
            in_code[number] = name;
    CHECK_EQ(in_spec.size(), 25u);
    CHECK(in_spec == in_code);
}

TEST_CASE("SPEC: the table of errors is the code's, with its sentences, in its order")
{
    const auto rows = table("| code | meaning | what the caller can do |");
    REQUIRE_EQ(rows.size(), static_cast<std::size_t>(Errc::io) + 1);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto& row = info(static_cast<Errc>(i));
        CHECK_EQ(rows[i].at(0), row.token);
        CHECK_EQ(rows[i].at(1), row.sentence);
        CHECK_EQ(rows[i].at(2), row.advice);
        CHECK_EQ(errc_from_token(rows[i].at(0)), static_cast<Errc>(i));
    }
}

TEST_CASE("SPEC: the words of section 1 are the code's")
{
    using Words = std::set<std::string>;
    const auto all = [](auto... values) { return Words{std::string(token(values))...}; };
    CHECK(words("transfer") == all(Transfer::synchronized, Transfer::streaming));
    CHECK(words("delivery") == all(Delivery::data, Delivery::notification));
    CHECK(words("state") == all(State::starting, State::idle, State::busy, State::halted, State::stopping));
    CHECK(words("policy") == all(ExceptionPolicy::skip, ExceptionPolicy::halt));
    CHECK(words("parameter type")
          == all(ParameterType::integer, ParameterType::number, ParameterType::text, ParameterType::flag));
}

TEST_CASE("SPEC: the tables of fates and of reasons are the code's, in its order")
{
    const auto listed = [](const std::string& heading) {
        std::vector<std::string> words;
        for (const auto& row : table(heading))
            words.push_back(row.at(0));
        return words;
    };
    std::vector<std::string> in_code;
    for (std::size_t i = 0; i < fates; ++i)
        in_code.emplace_back(token(static_cast<Fate>(i)));
    CHECK(listed("| fate | meaning |") == in_code);
    in_code.clear();
    for (int i = 1; !token(static_cast<Reason>(i)).empty(); ++i)
        in_code.emplace_back(token(static_cast<Reason>(i)));
    CHECK(in_code.size() > 10);
    CHECK(listed("| why | meaning |") == in_code);
}

TEST_CASE("SPEC: the limits of section 3 are the code's")
{
    const JsonLimits json;
    CHECK_EQ(limit("first packet of a peer"), std::to_string(protocol::hello_limits.header + protocol::prefix_size));
    CHECK_EQ(limit("header"), std::to_string(protocol::Limits{}.header));
    CHECK_EQ(limit("header"), std::to_string(json.bytes));
    CHECK_EQ(limit("body"), std::to_string(protocol::Limits{}.body));
    CHECK_EQ(limit("JSON depth"), std::to_string(json.depth));
    CHECK_EQ(limit("JSON keys"), std::to_string(json.keys));
    CHECK_EQ(limit("JSON string or key"), std::to_string(json.string_bytes));
}

TEST_CASE("SPEC: the packets written out in hex are packets")
{
    const auto blocks = hex_blocks();
    REQUIRE_EQ(blocks.size(), 4u);
    std::string types;
    for (const auto& bytes : blocks) {
        PacketReader reader(false);
        reader.feed(bytes);
        REQUIRE_EQ(reader.packets().size(), 1u);
        CHECK_FALSE(reader.inside());
        types += std::string(protocol::token(reader.packets()[0].type)) + " ";
    }
    CHECK_EQ(types, "request event ping reference ");
}

TEST_CASE("SPEC: the request written out in hex is what the code writes")
{
    const auto header = protocol::to_text(protocol::Request{.epoch = 7, .id = 2, .done = 1, .worked = 1});
    const auto prefix = protocol::encode(protocol::make_packet(protocol::PacketType::request, header, 1).prefix());
    CHECK(hex_blocks().at(0) == std::string(prefix.begin(), prefix.end()) + header);
}

TEST_CASE("SPEC: the reference written out in hex is what the code writes and reads")
{
    const protocol::Reference reference{
        .slot = {.segment = 0, .index = 3, .generation = 17}, .offset = 0, .size = 6220800};
    const auto packet = protocol::make_packet(protocol::PacketType::reference, R"({"output":"pixel"})", 1,
                                              protocol::to_body(reference));
    const auto prefix = protocol::encode(packet.prefix());
    const std::string body(reinterpret_cast<const char*>(packet.body.data()), packet.body.size());
    CHECK(hex_blocks().at(3) == std::string(prefix.begin(), prefix.end()) + std::string(packet.header_text()) + body);
    const auto read = protocol::reference_from_body(packet.body);
    CHECK(read.slot == reference.slot);
    CHECK_EQ(read.size, reference.size);
}

TEST_CASE("SPEC: the JSON of the worked dialogue is what the code reads")
{
    int registrations = 0, requests = 0, confirmations = 0;
    std::istringstream lines(read_file("SPEC.md"));
    for (std::string line; std::getline(lines, line);) {
        const auto begin = line.find('{'), end = line.rfind('}');
        if (begin == std::string::npos || (line[0] != '>' && line[0] != '<') || line.find("…") != std::string::npos)
            continue;
        const Json header = parse_json(std::string_view(line).substr(begin, end - begin + 1));
        const auto type = line.substr(2, line.find(' ', 2) - 2);
        if (type == "register")
            registrations += protocol::registration_from_json(header).output == "image";
        else if (type == "request")
            requests += protocol::request_from_json(header).epoch == 7;
        else if (type == "confirmation")
            confirmations += protocol::confirmation_from_json(header).ok;
    }
    CHECK_EQ(registrations, 1);
    CHECK_EQ(requests, 3);
    CHECK_EQ(confirmations, 2);
}

}  // namespace hive::wire
