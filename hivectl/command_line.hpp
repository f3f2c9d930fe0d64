// CLI11, for the files that declare options; everything else of hivectl does without it.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>

#include <hive/transfer.hpp>

#include <cstdlib>

namespace hivectl {

/// A duration in seconds, within what a deadline can be.
inline CLI::Validator seconds(double least = 0.001, double most = 1e8)
{
    const auto problem = [=](std::string& text) -> std::string {
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        const bool number = !text.empty() && *end == '\0';
        if (number && value >= least && value <= most)
            return {};
        return text + " is not a number of seconds" + (number ? value < least ? ", or too small" : ", or too large" : "");
    };
    return {problem, "", "seconds"};
}

/// How pictures travel, as `hive::is_encoding` knows it.
inline CLI::Validator encoding_word()
{
    const auto problem = [](std::string& text) {
        return hive::is_encoding(text) ? std::string() : text + " is not written as an encoding; write for example raw, png, jpeg or jpeg:80";
    };
    return {problem, "", "encoding"};
}

}  // namespace hivectl
