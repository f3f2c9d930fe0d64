// Encodings of images: raw on one machine, JPEG across a network, or by the option of the connection.
#include "swarm.hpp"

#include <hive/event/module.hpp>
#include <hive/event/mailbox.hpp>

#include <doctest/doctest.h>

#include <fstream>
#include <future>
#include <sys/stat.h>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// Receives one output over a path that the test selects, as a module of its own.
class Receiver {
public:
    Receiver(const std::string& name, const std::string& address, const std::string& output,
             const std::string& accepts = "*/*", const std::string& encoding = "")
        : module_({.self = {.name = name, .kind = "application", .epoch = 1}, .limits = {}, .timing = {}})
    {
        hive::event::IntakeSpec spec{.sender = "camera",
                                     .output = output,
                                     .address = hive::transport::parse_address(address),
                                     .input = output,
                                     .receiver = name,
                                     .accepts = accepts,
                                     .options = {}};
        spec.options.encoding = encoding;
        module_.start();
        std::promise<hive::event::Outcome> registered;
        module_.call([&] {
            module_.add_intake(spec, [this](hive::Event event) { mailbox_.push(std::move(event)); })
                ->start([&](const hive::event::Outcome& outcome) { registered.set_value(outcome); });
        });
        const auto outcome = registered.get_future().get();  // at its own timeout at the latest
        if (const auto* error = std::get_if<hive::Error>(&outcome))
            throw hive::Error(*error);
    }
    ~Receiver() { module_.end(); }
    Receiver(const Receiver&) = delete;
    Receiver& operator=(const Receiver&) = delete;

    hive::Event next()
    {
        auto item = module_.next(mailbox_, Clock::now() + patient(10'000ms));
        REQUIRE(item);
        return std::get<hive::Event>(std::move(*item));
    }

private:
    hive::event::Mailbox mailbox_;
    hive::event::Module module_;
};

constexpr std::size_t pixels = 640 * 480 * 3;

std::string local_address(const Swarm& swarm, const std::string& drone)
{
    return "unix:" + (swarm.home() / (drone + ".sock")).string();
}

/// The listening address that a drone reports.
std::string tcp_address(const Swarm& swarm, const std::string& drone)
{
    const std::string text = swarm.log(drone), before = "listening on ";
    const auto begin = text.find(before + "tcp://");
    REQUIRE(begin != std::string::npos);
    return text.substr(begin + before.size(), text.find('\n', begin) - begin - before.size());
}

Process camera_with_port(const Swarm& swarm, const std::vector<std::string>& settings = {"fps=30"})
{
    return swarm.drone("camera", "camera", settings, {"--listen", "tcp://127.0.0.1:0", "--insecure"});
}

/// `encoding` of each edge, by its receiver.
Json encodings(const Swarm& swarm)
{
    Json found;
    for (const auto& row : Json::parse(swarm.hivectl_done({"connections", "--json"})))
        found[row.at("to").get<std::string>()] = row.at("encoding");
    return found;
}

bool is_jpeg(const hive::Event& event)
{
    return event.body.size() > 1000 && event.body.data()[0] == 0xFF && event.body.data()[1] == 0xD8;
}

}  // namespace

TEST_CASE("encoding: on one machine a camera's frames are plain pixels, also over TCP, unless JPEG is asked for")
{
    const Swarm swarm;
    const auto camera = camera_with_port(swarm);
    const auto tcp = tcp_address(swarm, "camera");
    Receiver near("near", local_address(swarm, "camera"), "image"), by_tcp("tcp", tcp, "image");
    Receiver far("far", tcp, "image", "*/*", "jpeg");
    for (auto* receiver : {&near, &by_tcp}) {
        const auto raw = receiver->next();
        CHECK(raw.type == "image/raw");
        CHECK(raw.body.size() == pixels);
        CHECK(raw.header.at("pixel_format") == "bgr8");
    }
    const auto jpeg = far.next();
    CHECK(jpeg.type == "image/jpeg");
    CHECK(is_jpeg(jpeg));
    CHECK(jpeg.body.size() < pixels / 4);
    CHECK(jpeg.header.at("width") == 640);
    CHECK(jpeg.header.contains("truth"));
    CHECK_FALSE(jpeg.header.contains("stride"));
    CHECK(encodings(swarm) == Json{{"near", "as it is"}, {"tcp", "as it is"}, {"far", "jpeg"}});
}

TEST_CASE("encoding: what a connection asks for is what it gets, on any way")
{
    const Swarm swarm;
    const auto camera = camera_with_port(swarm);
    const auto near = local_address(swarm, "camera"), far = tcp_address(swarm, "camera");
    Receiver raw("raw", far, "image", "*/*", "raw"), png("png", near, "image", "*/*", "png");
    Receiver fine("fine", near, "image", "*/*", "jpeg:95"), coarse("coarse", near, "image", "*/*", "jpeg:20");
    CHECK(raw.next().body.size() == pixels);
    CHECK(png.next().type == "image/png");
    const auto large = fine.next(), small = coarse.next();
    CHECK(is_jpeg(large));
    CHECK(is_jpeg(small));
    CHECK(small.body.size() * 2 < large.body.size());
    CHECK_THROWS_AS(Receiver("wrong", near, "image", "*/*", "webp"), hive::Error);
    CHECK_THROWS_AS(Receiver("wrong", near, "image", "image/png", "raw"), hive::Error);
    CHECK_THROWS_AS(Receiver("wrong", near, "exceptions", "*/*", "raw"), hive::Error);
}

TEST_CASE("encoding: a receiver on the same machine that takes JPEG only gets JPEG")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"fps=30"});
    Receiver receiver("viewer", local_address(swarm, "camera"), "image", "image/jpeg,application/json");
    CHECK(is_jpeg(receiver.next()));
    CHECK(encodings(swarm) == Json{{"viewer", "jpeg"}});
}

TEST_CASE("encoding: in a lossless stream over TCP nothing is skipped and nothing overtakes")
{
    const Swarm swarm;
    const auto camera = camera_with_port(swarm, {"pace=demand"});
    Receiver receiver("far", tcp_address(swarm, "camera"), "image", "*/*", "jpeg");
    const auto first = receiver.next().identity.sequence;
    for (std::int64_t i = 1; i <= 20; ++i) {
        const auto event = receiver.next();  // requests the next one once this one is released
        CHECK(is_jpeg(event));
        CHECK(event.identity.sequence == first + i);
    }
}

TEST_CASE(
    "encoding: a JPEG file travels byte for byte, on one machine and over TCP, unless another quality is asked for")
{
    const Swarm swarm;
    const auto file = swarm.home() / "image.jpg";
    {
        const auto scene = swarm.drone("camera", "camera", {"fps=30"});
        swarm.hivectl_done({"snap", "camera", file.string()});
    }
    const auto size = std::filesystem::file_size(file);
    const auto camera = camera_with_port(swarm, {"source=" + file.string()});
    Receiver near("near", local_address(swarm, "camera"), "image"), far("far", tcp_address(swarm, "camera"), "image");
    Receiver coarse("coarse", local_address(swarm, "camera"), "image", "*/*", "jpeg:20");
    CHECK(near.next().body.size() == size);
    CHECK(far.next().body.size() == size);
    CHECK(coarse.next().body.size() < size);
}

TEST_CASE("encoding: an image that cannot be encoded is an exception, and goes as it is")
{
    const Swarm swarm;
    const auto file = swarm.home() / "image.jpg";
    {
        const auto scene = swarm.drone("camera", "camera", {"fps=30"});
        swarm.hivectl_done({"snap", "camera", file.string()});
    }
    // Half of the pixels and an end: complete by its structure; only decoding detects the loss.
    std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
    std::ofstream(file, std::ios::binary | std::ios::app) << "\xff\xd9";
    const auto size = std::filesystem::file_size(file);
    const auto camera = swarm.drone("camera", "camera", {"source=" + file.string(), "fps=10"});
    Receiver receiver("viewer", local_address(swarm, "camera"), "image", "*/*", "jpeg:60");
    CHECK(receiver.next().body.size() == size);
    const auto exception = swarm.application().status("camera").last_exception.value();
    CHECK(exception.code == "malformed");
    CHECK(exception.text.starts_with("jpeg:60: "));
}

TEST_CASE("encoding: the shell asks for it, connections show it, and a wrong word is refused in words")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"fps=30"});
    const auto face = swarm.drone("face", "face"), one = swarm.drone("sleeper", "one"),
               two = swarm.drone("sleeper", "two");
    swarm.hivectl_done({"connect", "camera", "face"});
    swarm.hivectl_done({"connect", "camera", "one", "--encoding", "jpeg:60"});
    swarm.hivectl_done({"connect", "camera", "two", "--encoding", "raw"});
    CHECK(encodings(swarm) == Json{{"face.image", "as it is"}, {"one.image", "jpeg:60"}, {"two.image", "raw"}});
    CHECK(swarm.hivectl_done({"connections"}).find("ENCODING") != std::string::npos);
    CHECK(Json::parse(swarm.hivectl_done({"results", "one", "-n", "1"})).at("header").at("seq") >= 1);
    const auto unknown = swarm.hivectl({"connect", "camera", "one", "--encoding", "webp"});
    CHECK(unknown.exit_code == 2);
    CHECK(unknown.err.find("there are jpeg, jpeg:1 to jpeg:100, png, raw") != std::string::npos);
    const auto misspelt = swarm.hivectl({"connect", "camera", "one", "--encoding", "JPEG"});
    CHECK(misspelt.exit_code == 2);
    CHECK(misspelt.err.find("jpeg:80") != std::string::npos);
    const auto impossible = swarm.hivectl({"connect", "face.faces", "one", "--encoding", "raw"});
    CHECK(impossible.exit_code == 2);
    CHECK(encodings(swarm).at("one.image") == "jpeg:60");  // as before
}

TEST_CASE("encoding: snap saves what the ending of the file says")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"fps=30"});
    const auto begin_of = [&](const std::string& name) {
        const auto file = swarm.home() / name;
        const auto done = swarm.hivectl({"snap", "camera", file.string()});
        REQUIRE(done.exit_code == 0);
        CHECK(done.err == "");
        std::ifstream in(file, std::ios::binary);
        std::string begin(4, '\0');
        in.read(begin.data(), 4);
        return begin;
    };
    CHECK(begin_of("a.png") == "\x89PNG");
    CHECK(begin_of("a.jpg").starts_with("\xff\xd8"));
    CHECK(begin_of("a.JPEG").starts_with("\xff\xd8"));
    namespace fs = std::filesystem;
    fs::create_symlink("b.jpg", swarm.home() / "link.jpg");
    CHECK(begin_of("link.jpg").starts_with("\xff\xd8"));
    CHECK(fs::is_symlink(swarm.home() / "link.jpg"));
    CHECK(begin_of("b.jpg").starts_with("\xff\xd8"));
    const auto pipe = (swarm.home() / "pipe.jpg").string();
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    auto reader = Process({"/bin/cat", pipe}, {}, swarm.home() / "read.jpg");
    CHECK(swarm.hivectl({"snap", "camera", pipe}).exit_code == 0);
    CHECK(reader.wait(patient(5000ms)) == 0);
    CHECK(fs::is_fifo(pipe));
    CHECK(text_of(swarm.home() / "read.jpg").starts_with("\xff\xd8"));
    CHECK(swarm.hivectl({"snap", "camera", swarm.home().string()}).exit_code == 1);
    const auto bitmap = swarm.hivectl({"snap", "camera", (swarm.home() / "a.bmp").string()});
    CHECK(bitmap.exit_code == 2);
    CHECK(has(bitmap.err, "a.bmp does not say; name the file "));
    CHECK_FALSE(fs::exists(swarm.home() / "a.bmp"));
}
