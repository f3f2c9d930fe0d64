// What the machine allows through shared memory: a memfd of 8 slots, the numbers of the full ones in a ring, a futex to
// sleep on, and nothing else. The publisher takes the slot that was freed last: its lines are still in the cache.
//
//     bench_raw_shm copy  the picture is copied from the camera's buffer into the slot
//     bench_raw_shm zc    the camera has written into the slot: only header and tail are stamped
#include "../harness/board.hpp"
#include "../harness/transport.hpp"

#include <cstring>
#include <stdexcept>
#include <sys/mman.h>
#include <sys/stat.h>

namespace hive::bench {
namespace {

constexpr std::uint32_t slots = 8, ring = 64;
constexpr std::size_t page = 4096;

struct Control {
    alignas(64) Word head{0};      ///< frames published, or requests answered
    alignas(64) Word sleepers{0};  ///< receivers that sleep on head
    alignas(64) Word freed{0};     ///< rung when a frame was read while the publisher waits
    Word publisher_waits{0};
    alignas(64) std::array<std::atomic<std::uint8_t>, ring> slot_of;  ///< the slot of a frame
    struct alignas(64) Reader {
        Word tail{0};  ///< frames read
    };
    std::array<Reader, most_subscribers> readers;
    alignas(64) Word requests{0}, server_sleeps{0};
    Request request;
    Word ready{0};
};
static_assert(sizeof(Control) <= page);

/// The shared memory, made by the publisher or server, then mapped by the others.
class Segment {
public:
    Segment(std::size_t frame, Role role) : frame_(frame), stride_((frame + page - 1) / page * page)
    {
        const std::size_t size = page + slots * stride_;
        const bool maker = role == Role::publisher || role == Role::server;
        if (maker && ::ftruncate(frame_memory(), static_cast<off_t>(size)) != 0)
            throw std::runtime_error("cannot size the shared memory");
        if (!maker)
            await_size(size);
        void* memory = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, frame_memory(), 0);
        if (memory == MAP_FAILED)
            throw std::runtime_error("cannot map the shared memory");
        base_ = static_cast<std::byte*>(memory);
        maker ? fill() : read_all(size);
    }

    [[nodiscard]] Control& control() const { return *reinterpret_cast<Control*>(base_); }
    [[nodiscard]] std::span<std::byte> slot(std::uint32_t index) const { return {base_ + page + index * stride_, frame_}; }

private:
    static void await_size(std::size_t size)
    {
        struct stat status{};
        for (const auto end = now_ns() + 5 * second; ::fstat(frame_memory(), &status) == 0 && status.st_size < static_cast<off_t>(size); sleep_for(millisecond))
            if (now_ns() > end)
                throw std::runtime_error("nobody made the shared memory");
    }
    void fill()
    {
        for (std::uint32_t i = 0; i < slots; ++i)
            draw(slot(i), i % cameras);
        (new (base_) Control)->ready = 1;
    }
    void read_all(std::size_t size) const
    {
        while (control().ready == 0)
            sleep_for(millisecond);
        for (std::size_t i = 0; i < size; i += page)
            (void)*static_cast<volatile std::byte*>(base_ + i);
    }

    std::size_t frame_, stride_;
    std::byte* base_ = nullptr;
};

void put(const Frame& frame, std::span<std::byte> slot, std::uint32_t index, bool in_place)
{
    if (!in_place)
        return frame.produce(slot.data());
    Frame drawn = frame;
    drawn.header.camera = index % cameras;
    drawn.stamp(slot.data());
}

/// Sleeps until the word has this value.
void await(Word& word, std::uint32_t value, Word& sleepers)
{
    for (auto now = word.load(); now != value; now = word.load()) {
        ++sleepers;
        futex_wait(word, now);
        --sleepers;
    }
}

class ShmPublisher : public PushPublisher {
public:
    explicit ShmPublisher(const Run& run) : segment_(run.size, run.role), readers_(run.subscribers), in_place_(run.is("zc"))
    {
        for (std::uint32_t i = 0; i < slots; ++i)
            held_by_[i] = -1 - static_cast<std::int64_t>(i);
    }

private:
    void send(const Frame& frame) override
    {
        Control& control = segment_.control();
        await_slot(control);
        const auto slot = newest_free(slowest(control));
        held_by_[slot] = head_;
        control.slot_of[head_ % ring] = static_cast<std::uint8_t>(slot);
        put(frame, segment_.slot(slot), slot, in_place_);
        control.head = ++head_;
        if (control.sleepers > 0)
            futex_wake(control.head);
    }

    void await_slot(Control& control)
    {
        const auto full = [&] { return head_ - slowest(control) >= slots - 1; };
        while (full()) {
            const auto freed = control.freed.load();
            control.publisher_waits = 1;
            if (full())
                futex_wait(control.freed, freed, 100 * millisecond);
            control.publisher_waits = 0;
        }
    }

    [[nodiscard]] std::uint32_t slowest(const Control& control) const
    {
        std::uint32_t tail = head_;
        for (int i = 0; i < readers_; ++i)
            tail = std::min(tail, control.readers[static_cast<std::size_t>(i)].tail.load());
        return tail;
    }

    [[nodiscard]] std::uint32_t newest_free(std::int64_t read) const
    {
        std::uint32_t best = slots;
        for (std::uint32_t i = 0; i < slots; ++i)
            if (held_by_[i] < read && (best == slots || held_by_[i] > held_by_[best]))
                best = i;
        return best;
    }

    Segment segment_;
    int readers_;
    bool in_place_;
    std::uint32_t head_ = 0;
    std::array<std::int64_t, slots> held_by_{};  ///< the last frame in each slot
};

class ShmSubscriber : public Subscriber {
public:
    explicit ShmSubscriber(const Run& run) : segment_(run.size, run.role), index_(static_cast<std::size_t>(run.index)) {}

    void receive(const OnFrame& on_frame) override
    {
        Control& control = segment_.control();
        Word& tail = control.readers[index_].tail;
        for (std::uint32_t next = tail;;) {
            while (control.head == next) {
                ++control.sleepers;
                futex_wait(control.head, next);
                --control.sleepers;
            }
            const bool more = on_frame(segment_.slot(control.slot_of[next % ring]));
            tail = ++next;
            if (control.publisher_waits > 0) {
                ++control.freed;
                futex_wake(control.freed);
            }
            if (!more)
                return;
        }
    }

private:
    Segment segment_;
    std::size_t index_;
};

class ShmServer : public Server {
public:
    explicit ShmServer(const Run& run) : segment_(run.size, run.role), in_place_(run.is("zc")) {}

    void serve(const std::function<void()>& serving, const OnRequest& on_request) override
    {
        Control& control = segment_.control();
        Frame answer{};
        serving();
        for (std::uint32_t number = 1;; ++number) {
            await(control.requests, number, control.server_sleeps);
            const bool more = on_request(control.request, answer);
            put(answer, segment_.slot(0), 0, in_place_);
            control.head = number;
            if (control.sleepers > 0)
                futex_wake(control.head);
            if (!more)
                return;
        }
    }

private:
    Segment segment_;
    bool in_place_;
};

class ShmClient : public Client {
public:
    explicit ShmClient(const Run& run) : segment_(run.size, run.role) {}

    bool ask(const Request& request, const FrameCheck& check) override
    {
        Control& control = segment_.control();
        control.request = request;
        control.requests = ++number_;
        if (control.server_sleeps > 0)
            futex_wake(control.requests);
        await(control.head, number_, control.sleepers);
        return check.whole(segment_.slot(0));
    }

private:
    Segment segment_;
    std::uint32_t number_ = 0;
};

class RawShm : public Transport {
public:
    std::unique_ptr<Publisher> publisher(const Run& run) const override { return std::make_unique<ShmPublisher>(run); }
    std::unique_ptr<Subscriber> subscriber(const Run& run) const override { return std::make_unique<ShmSubscriber>(run); }
    std::unique_ptr<Server> server(const Run& run) const override { return std::make_unique<ShmServer>(run); }
    std::unique_ptr<Client> client(const Run& run) const override { return std::make_unique<ShmClient>(run); }
};

}  // namespace
}  // namespace hive::bench

int main(int argc, char** argv) { return hive::bench::row_main("raw_shm", hive::bench::RawShm(), argc, argv); }
