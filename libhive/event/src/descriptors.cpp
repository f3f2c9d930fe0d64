// Watches the descriptors in the io_context that also receives answers, so that one wait suffices.
#include <hive/event/descriptors.hpp>

#include <asio/posix/stream_descriptor.hpp>

#include <list>
#include <memory>

namespace hive::event {

void wait(Loop& loop, Clock::time_point deadline, const std::function<bool()>& done,
          const std::vector<int>& descriptors)
{
    using Descriptor = asio::posix::stream_descriptor;
    const auto readable = std::make_shared<bool>(false);
    std::list<Descriptor> watched;
    loop.call([&] {
        for (const int descriptor : descriptors)
            watched.emplace_back(loop.context(), descriptor)
                .async_wait(Descriptor::wait_read,
                            [readable](const std::error_code& error) { *readable = *readable || !error; });
    });
    loop.wait(deadline, [&] { return *readable || done(); });
    loop.call([&] {
        for (auto& one : watched)
            one.release();  // the caller closes it
        watched.clear();
    });
}

}  // namespace hive::event
