#include <busbar/server/method.hpp>

#include "call_part.hpp"

namespace busbar::server {

CallBatch::CallBatch(detail::CallPart& part)
    : part_{&part}, items_{part.items}, results_{part.results}, caller_{part.caller}
{
}

CallBatch& CallBatch::operator=(CallBatch&& other) noexcept
{
    if (this != &other) {
        complete();
        part_ = std::exchange(other.part_, nullptr);
        items_ = std::exchange(other.items_, {});
        results_ = std::exchange(other.results_, nullptr);
        caller_ = other.caller_;
    }
    return *this;
}

LogSink& CallBatch::log() const
{
    return part_->source().log();
}

bool CallBatch::is_abandoned() const
{
    return part_ != nullptr && part_->is_abandoned();
}

void CallBatch::complete()
{
    items_ = {};
    if (part_ != nullptr) {
        std::exchange(part_, nullptr)->complete();
    }
}

void CallBatch::fail(StatusCode status)
{
    items_ = {};
    if (part_ != nullptr) {
        std::exchange(part_, nullptr)->complete(status);
    }
}

} // namespace busbar::server
