// Outputs that give their events in other encodings, by code of the caller.
#include "world.hpp"

#include <algorithm>
#include <optional>
#include <thread>
#include <vector>

using namespace world;

namespace {

constexpr const char* encodings = R"([{"word": "loud", "type": "text/loud"},
                                      {"word": "twice", "type": "text/twice", "least": 1, "most": 9}])";

/// What the encoder does, and where it was called.
struct Encoding {
    hive_code fails = HIVE_OK;
    bool gives = true;
    hive_drone* release = nullptr;
    std::atomic<int> calls = 0;
    std::atomic<std::thread::id> thread{};
};

/// "abc" as "ABC", or as often as it is asked for.
hive_code encode(void* user, const hive_event* event, const char* encoding, hive_encoded* encoded)
{
    auto& self = *static_cast<Encoding*>(user);
    ++self.calls;
    self.thread = std::this_thread::get_id();
    if (auto* drone = std::exchange(self.release, nullptr))
        hive_release(drone);
    if (self.fails != HIVE_OK)
        return hive_fail(self.fails, "not today");
    const void* bytes = nullptr;
    std::size_t size = 0;
    REQUIRE(hive_event_bytes(event, &bytes, &size) == HIVE_OK);
    std::string text(static_cast<const char*>(bytes), size);
    const std::string wanted = encoding;
    if (wanted == "loud")
        std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    else
        text = text + "|" + (wanted.size() > 5 ? wanted.substr(6) : "");
    hive_body* body = nullptr;
    REQUIRE(hive_body_new(text.data(), text.size(), &body) == HIVE_OK);
    const std::string header = R"({"as": ")" + wanted + R"("})";
    const hive_code code =
        self.gives ? hive_encoded_give(encoded, wanted == "loud" ? nullptr : header.data(), header.size(), body)
                   : HIVE_OK;
    hive_release(body);
    return code;
}

/// A drone that this thread drives.
struct Probe {
    Probe()
    {
        REQUIRE(hive_drone_encoded_output(drone, "out", "text/plain,text/loud,text/twice", "", encodings, encode,
                                          &encoding, &output)
                == HIVE_OK);
        REQUIRE(hive_drone_start(drone) == HIVE_OK);
    }
    ~Probe()
    {
        hive_release(application);
        hive_release(output);
        if (!released)
            hive_release(drone);
    }
    Probe(const Probe&) = delete;
    Probe& operator=(const Probe&) = delete;

    hive_code collect(const char* wanted, hive_collector** collector)
    {
        Json options{{"connection", {{"transfer", "stream"}}}};
        if (*wanted)
            options["connection"]["encoding"] = wanted;
        return hive_application_collect(application, R"(["probe"])", options.dump().c_str(), collector);
    }
    hive_collector* collector(const char* wanted)
    {
        hive_collector* made = nullptr;
        REQUIRE_MESSAGE(collect(wanted, &made) == HIVE_OK, error());
        return made;
    }
    hive_code emit() { return hive_output_emit(output, R"({"n": 1})", 8, "abc", 3, nullptr); }

    Home home;
    Encoding encoding;
    hive_drone* drone = new_drone("probe");
    hive_output* output = nullptr;
    hive_application* application = new_application();
    bool released = false;
};

/// "text/loud ABC {...}" of the next event.
std::string next_text(hive_collector* collector)
{
    hive_event* event = nullptr;
    REQUIRE_MESSAGE(hive_collector_next(collector, patient(5000ms).count(), &event) == HIVE_OK, error());
    REQUIRE(event);
    Text info;
    const char* header = nullptr;
    const void* bytes = nullptr;
    std::size_t size = 0;
    REQUIRE(hive_event_info(event, info.place(), nullptr) == HIVE_OK);
    REQUIRE(hive_event_header(event, &header, nullptr) == HIVE_OK);
    REQUIRE(hive_event_bytes(event, &bytes, &size) == HIVE_OK);
    const std::string whole = info.json().at("type").get<std::string>() + " "
                              + std::string(static_cast<const char*>(bytes), size) + " " + header;
    hive_release(event);
    return whole;
}

}  // namespace

TEST_CASE("c: each connection gets the encoding that it asks for, made on a thread of its own")
{
    const auto before = hive_handle_count();
    {
        Probe probe;
        auto *plain = probe.collector(""), *loud = probe.collector("loud"), *twice = probe.collector("twice:7");
        REQUIRE(probe.emit() == HIVE_OK);
        CHECK(next_text(plain) == R"(text/plain abc {"n":1})");
        CHECK(next_text(loud) == R"(text/loud ABC {"n":1})");
        CHECK(next_text(twice) == R"(text/twice abc|7 {"as":"twice:7"})");
        CHECK(probe.encoding.calls == 2);
        CHECK(probe.encoding.thread.load() != std::this_thread::get_id());
        for (auto* collector : {plain, loud, twice})
            hive_release(collector);
    }
    CHECK(hive_handle_count() == before);
}

TEST_CASE("c: an encoding that there is not is refused, with those that there are")
{
    Probe probe;
    hive_collector* collector = nullptr;
    for (const char* wrong : {"quiet", "loud:1", "twice:0", "twice:10", "twice:1:1"}) {
        CAPTURE(wrong);
        CHECK(probe.collect(wrong, &collector) == HIVE_INVALID_ARGUMENT);
    }
    CHECK(probe.collect("quiet", &collector) == HIVE_INVALID_ARGUMENT);
    CHECK(error().find("there is no encoding \"quiet\"") != std::string::npos);
    CHECK(std::string(hive_error_advice()) == "there are loud, twice, twice:1 to twice:9");
}

TEST_CASE("c: an encoder that fails or gives nothing is an exception of the drone, and the event travels as it is")
{
    Probe probe;
    hive_collector* exceptions = nullptr;
    REQUIRE(hive_application_exceptions(probe.application, R"(["probe"])", &exceptions) == HIVE_OK);
    auto* loud = probe.collector("loud");
    probe.encoding.fails = HIVE_UNSUPPORTED;
    REQUIRE(probe.emit() == HIVE_OK);
    CHECK(next_text(loud) == R"(text/plain abc {"n":1})");
    CHECK(next_text(exceptions).find("loud: not today") != std::string::npos);
    probe.encoding.fails = HIVE_OK;
    probe.encoding.gives = false;
    REQUIRE(probe.emit() == HIVE_OK);
    CHECK(next_text(loud) == R"(text/plain abc {"n":1})");
    CHECK(next_text(exceptions).find("the encoder returned nothing") != std::string::npos);
    hive_release(loud);
    hive_release(exceptions);
}

TEST_CASE("c: a drone that is released by its own encoder ends all the same")
{
    Probe probe;
    auto* loud = probe.collector("loud");
    probe.encoding.release = probe.drone;
    probe.released = true;
    REQUIRE(probe.emit() == HIVE_OK);
    CHECK(hive_application_wait(probe.application, "probe", "gone", patient(10'000ms).count()) == HIVE_OK);
    hive_release(loud);
}

TEST_CASE("c: what is wrong with a declaration of encodings is said")
{
    const Home home;
    auto* drone = new_drone("probe");
    hive_output* output = nullptr;
    const auto declared = [&](const char* text) {
        return hive_drone_encoded_output(drone, "out", "a/b", "", text, encode, nullptr, &output);
    };
    for (const char* wrong :
         {"", "{}", "[]", "[1]", R"([{"type": "a/b"}])", R"([{"word": "x"}])", R"([{"word": "x:1", "type": "a/b"}])",
          R"([{"word": "x y", "type": "a/b"}])", R"([{"word": "x", "type": "a/b", "most": "9"}])",
          R"([{"word": "x", "type": "a/b", "least": 5, "most": 4}])",
          R"([{"word": "x", "type": "a/b"}, {"word": "x", "type": "a/c"}])"}) {
        CAPTURE(wrong);
        CHECK(declared(wrong) == HIVE_INVALID_ARGUMENT);
    }
    CHECK(declared(nullptr) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_drone_encoded_output(drone, "out", "a/b", "", encodings, nullptr, nullptr, &output)
          == HIVE_INVALID_ARGUMENT);
    CHECK(output == nullptr);
    hive_release(drone);
}
