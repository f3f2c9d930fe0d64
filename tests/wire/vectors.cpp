// Reading and comparing golden vectors.
#include "vectors.hpp"

#include <fstream>
#include <sstream>

namespace hive::wire {

std::string read_file(const std::string& name)
{
    std::ifstream file(std::string(HIVE_PROTOCOL_DIR) + "/" + name, std::ios::binary);
    REQUIRE_MESSAGE(file.good(), name);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<Json> read_vectors(const std::string& name, std::size_t least)
{
    std::istringstream lines(read_file("vectors/" + name));
    std::vector<Json> rows;
    for (std::string line; std::getline(lines, line);)
        if (!line.empty())
            rows.push_back(Json::parse(line));
    REQUIRE_GE(rows.size(), least);
    return rows;
}

std::string from_hex(std::string_view hex)
{
    std::string bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
        bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
    return bytes;
}

std::string to_hex(std::string_view bytes)
{
    constexpr std::string_view digits = "0123456789abcdef";
    std::string hex;
    for (const unsigned char byte : bytes)
        hex += {digits[byte >> 4], digits[byte & 15]};
    return hex;
}

std::string input_of(const Json& row, bool parts_are_hex)
{
    if (row.contains("text"))
        return row.at("text").get<std::string>();
    if (row.contains("hex"))
        return from_hex(row.at("hex").get<std::string>());
    std::string input;
    for (const auto& part : row.at("parts")) {
        const auto text = part.at(0).get<std::string>();
        const auto piece = parts_are_hex ? from_hex(text) : text;
        for (int i = part.at(1).get<int>(); i > 0; --i)
            input += piece;
    }
    return input;
}

std::optional<Errc> error_of(const std::function<void()>& action)
{
    try {
        action();
    } catch (const Error& error) {
        return error.code();
    }
    return std::nullopt;
}

void check_outcome(const Json& row, std::optional<Errc> error)
{
    const std::string outcome = error ? std::string(info(*error).token) : "ok";
    CHECK_EQ(outcome, row.value("error", "ok"));
}

}  // namespace hive::wire
