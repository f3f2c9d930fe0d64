// Codes and texts of errors.
#include "world.hpp"

#include <hive/error.hpp>
#include <hive/version.hpp>

using namespace world;

TEST_CASE("c: every Errc has a code with the same token, sentence, advice and exit code")
{
    for (int i = 0; i <= static_cast<int>(hive::Errc::io); ++i) {
        const auto& row = hive::info(static_cast<hive::Errc>(i));
        const hive_code code = i + 1;
        CHECK(hive_code_token(code) == std::string(row.token));
        CHECK(hive_code_sentence(code) == std::string(row.sentence));
        CHECK(hive_code_advice(code) == std::string(row.advice));
        CHECK(hive_code_exit_code(code) == row.exit_code);
    }
    CHECK(hive_code_token(HIVE_IO + 1) == nullptr);
    CHECK(hive_code_token(-1) == nullptr);
    CHECK(hive_code_exit_code(-1) == -1);
    CHECK(hive_code_token(HIVE_OK) == std::string("ok"));
    CHECK(hive_code_token(HIVE_NOT_FOUND) == std::string("not_found"));
    CHECK(hive_code_token(HIVE_STOPPED) == std::string("stopped"));
}

TEST_CASE("c: the last error is that of the thread, with a text and an advice")
{
    CHECK(hive_fail(HIVE_REFUSED, "not today") == HIVE_REFUSED);
    std::thread([] {
        CHECK(hive_error_code() == HIVE_OK);
        CHECK(hive_fail(HIVE_IO, "other") == HIVE_IO);
    }).join();
    CHECK(hive_error_code() == HIVE_REFUSED);
    CHECK(error() == "not today");
    CHECK(hive_error_advice() == std::string(hive_code_advice(HIVE_REFUSED)));
    CHECK(hive_fail(HIVE_OK, nullptr) == HIVE_FAILED);
    CHECK(hive_fail(4711, "strange") == HIVE_FAILED);
    CHECK(error() == "strange");
}

TEST_CASE("c: the versions are those of the library")
{
    CHECK(hive_version() == std::string(hive::version()));
    CHECK(hive_protocol_version() == hive::protocol_version());
    CHECK(hive_abi_version() == HIVE_ABI_VERSION);
}

TEST_CASE("c: options that cannot be are refused with a text that names them")
{
    const Home home;
    hive_drone* drone = nullptr;
    CHECK(hive_drone_new("probe", "", R"({"nmae": "x"})", &drone) == HIVE_INVALID_ARGUMENT);
    CHECK(error().find("nmae") != std::string::npos);
    CHECK(hive_drone_new("probe", "", R"({"name": 1})", &drone) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_drone_new("probe", "", "{", &drone) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_drone_new("probe", "", "[]", &drone) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_drone_new("probe", "", R"({"name": "../x"})", &drone) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_drone_new("probe", "", R"({"on_exception": "never"})", &drone) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_drone_new("probe", "", R"({"listen": ["tcp://0.0.0.0:1"]})", &drone) == HIVE_NOT_PERMITTED);
    CHECK(hive_drone_new(nullptr, "", nullptr, &drone) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_drone_new("probe", nullptr, nullptr, nullptr) == HIVE_INVALID_ARGUMENT);
    CHECK(drone == nullptr);
    hive_application* application = nullptr;
    CHECK(hive_application_new(R"({"timeout_ms": -1})", &application) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_application_new(R"({"timeout": 1})", &application) == HIVE_INVALID_ARGUMENT);
    CHECK(application == nullptr);
}
