// A source for tests: numbered bodies with a checksum, live or on demand, almost free to produce.
#include <hive/drone.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

std::vector<unsigned char> bytes_of(std::int64_t index, int size)
{
    std::vector<unsigned char> bytes(static_cast<std::size_t>(size));
    std::iota(bytes.begin(), bytes.end(), static_cast<unsigned char>(index));
    return bytes;
}

class Ticker {
public:
    explicit Ticker(hive::Drone& drone)
        : drone_(drone),
          tick_(drone.output("tick", "application/octet-stream", "the bytes; the header has index and sum"))
    {
        drone.parameter("fps", fps_, hive::between(0.1, 100'000).in("fps"), "with pace=live");
        drone.parameter("bytes", bytes_, hive::between(0, 16 << 20).in("B"), "of one body");
        drone.parameter("padding", padding_, hive::between(0, 60'000).in("B"), "of text in the header");
        drone.parameter("pace", pace_, hive::one_of({"live", "demand"}),
                        "live never waits; demand gives the next one when all receivers ask");
        drone.parameter("count", count_, hive::at_least(0), "how many in all; 0: no end");
        drone.parameter("ends", ends_, {}, "the last of them is the end of the source");
        drone.parameter("decode_ms", decode_ms_, hive::at_least(0).in("ms"),
                        "how long a change takes until the next one is made, as a picture that is slow to decode");
        drone.on_change([this] { change(); });
        drone.main([this] { return step(); });
    }

private:
    void change()
    {
        begin_ = Clock::now() + std::chrono::milliseconds(decode_ms_);
        made_since_ = 0;
        if (ended_ && (count_ == 0 || made_ < count_))
            tick_.begin_source();
    }

    std::chrono::microseconds step()
    {
        if (count_ > 0 && made_ >= count_) {
            if (ends_ && !std::exchange(ended_, true)) {
                drone_.condition("end of source", hive::Reason::source_ended);
                tick_.end();
            }
            return 1s;
        }
        if (std::exchange(ended_, false))
            drone_.condition("");
        if (const auto left = begin_ - Clock::now(); pace_ == "demand" && left > 0s)
            return std::chrono::ceil<std::chrono::microseconds>(left);
        if (pace_ == "demand")
            return tick_.asked() ? (emit(true), 0us) : 1s;
        const auto due = begin_
                         + std::chrono::duration_cast<Clock::duration>(
                             std::chrono::duration<double>(static_cast<double>(made_since_) / fps_));
        if (Clock::now() >= due) {
            ++made_since_;
            emit(false);
            return 0us;
        }
        return std::chrono::ceil<std::chrono::microseconds>(due - Clock::now());
    }

    void emit(bool lossless)
    {
        auto body = bytes_of(++made_, bytes_);
        const auto sum = std::accumulate(body.begin(), body.end(), std::int64_t{0});
        hive::Json header{{"index", made_}, {"sum", sum}};
        for (int left = padding_; left > 0; left -= 10'000)
            header["padding-" + std::to_string(left)] =
                std::string(static_cast<std::size_t>(std::min(left, 10'000)), 'p');
        tick_.emit_captured(std::chrono::system_clock::now(), lossless, std::move(header),
                            [&] { return hive::Body(std::move(body)); });
    }

    hive::Drone& drone_;
    hive::Output tick_;
    double fps_ = 30;
    int bytes_ = 1000, count_ = 0, padding_ = 0, decode_ms_ = 0;
    std::string pace_ = "live";
    Clock::time_point begin_ = Clock::now();
    std::int64_t made_ = 0, made_since_ = 0;
    bool ends_ = true, ended_ = false;
};

}  // namespace

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"ticker", "Emits numbered bytes, for tests."}, [](hive::Drone& drone) {
        Ticker ticker(drone);
        drone.run();
    });
}
