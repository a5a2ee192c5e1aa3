#pragma once

#include <array>
#include <atomic>
#include <span>
#include <string_view>
#include <vector>

#include "server/data/data_call.hpp"

namespace busbar::server::detail {

/// Says that the result of a Method will not change any more; set on any thread.
struct ResultMark {
    /// The result's status, written before `is_set`.
    StatusCode status;
    std::atomic<bool> is_set{false};
};

class CallPart : public Part {
public:
    std::span<const CallItem> items;
    CallResult* results{nullptr};
    const MethodCaller* caller{nullptr};
};

struct CallTraits {
    using Item = CallItem;
    using Answer = CallResult;
    using Part = CallPart;
    static constexpr std::string_view callback = "DataSource::call";
    static constexpr bool changes_something = true;
    /// A busy Method does not fail the service.
    static constexpr std::array service_results{status::Bad_Shutdown};
    static LargeVector<CallResult> answers(std::size_t count, Memory memory)
    {
        return LargeVector<CallResult>(count, LargeVector<CallResult>::allocator_type{memory});
    }
    static void send(DataSource& source, Part& part) { source.call(CallBatch{part}); }
    static void own(CallResult&) {}
    static void release(Part&) {}
};

/// The Methods of one Call on their way to their sources and back.
using SourceMethodCall = SourceCall<CallTraits>;

} // namespace busbar::server::detail
