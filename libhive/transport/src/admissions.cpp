// The tokens of peers without a hello.
#include "admissions.hpp"

namespace hive::transport {

std::shared_ptr<void> Admissions::admit()
{
    ++count_;
    return {static_cast<void*>(this), [self = weak_from_this()](void*) {
                if (const auto hall = self.lock()) {
                    --hall->count_;
                    if (hall->freed)
                        hall->freed();
                }
            }};
}

}  // namespace hive::transport
