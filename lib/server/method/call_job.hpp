#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <busbar/binary/writer.hpp>
#include <busbar/types/method.hpp>

#include "call_part.hpp"
#include "method_needs.hpp"
#include "method_signature.hpp"

namespace busbar::server::detail {

/// The diagnostics of calls, and of the input arguments of each; both may be empty.
struct CallDiagnostics {
    Array<DiagnosticInfo> calls;
    std::vector<Array<DiagnosticInfo>> arguments;
};

/// Returns Good, or why the whole request is refused (Part 4, 5.12.2.3).
[[nodiscard]] StatusCode check_call(const CallRequest& request, std::size_t max_methods);
/// Returns the approximate memory of the request until it is answered.
[[nodiscard]] std::size_t cost_of(const CallRequest& request);

/// The work of one Call (Part 4, 5.12.2) that passed check_call: the Methods of one source are
/// passed in one batch, those of the server itself are carried out at once.
class CallJob {
public:
    /// `request` must not change until keep() or the end of the job.
    CallJob(const MethodNeeds& needs, const ServiceContext& context, const CallRequest& request);

    /// Returns true if the results are complete, else `owner` is notified.
    [[nodiscard]] bool start(SourceCallOwner& owner, TimePoint now);
    /// See SourceCall::service_result.
    [[nodiscard]] StatusCode service_result() const { return call_.service_result(); }
    [[nodiscard]] TimePoint next_deadline() const { return call_.next_deadline(); }
    /// Answers Bad_Timeout for late sources; true if nothing is pending any more.
    [[nodiscard]] bool handle_deadline(TimePoint now) { return call_.handle_deadline(now); }
    /// Checks the answers of the sources; before encode_results().
    void finish();
    /// Records each Method, if the log wants it (Part 5, 6.4.28): after finish(), or if the client
    /// gets `status` for the whole Call instead, which then is the status of Methods without a
    /// result. Only the first call records.
    void record(const Session& session, const RequestMark& mark, const CallRequest& request,
                StatusCode status = {});
    /// Returns the diagnostics of the calls and their arguments, after finish().
    [[nodiscard]] CallDiagnostics diagnose(ReturnDiagnostics& diagnostics,
                                           const CallRequest& request) const;
    /// Writes `results` and `diagnostic_infos` of the CallResponse.
    void encode_results(binary::Writer& writer, const CallDiagnostics& diagnostics) const;

    /// As WriteJob::keep.
    void keep(CallRequest request, std::vector<std::byte> message);

private:
    /// Memory whose addresses the sources have.
    struct Memory {
        Memory() = default;
        Memory(const Memory&) = delete;
        Memory& operator=(const Memory&) = delete;
        /// Overwrites the message if it contains a password or a key.
        ~Memory();

        MethodCaller caller;
        std::vector<std::byte> message;
        CallRequest request;
        /// One for each Method.
        std::unique_ptr<ResultMark[]> marks;
    };

    [[nodiscard]] std::optional<CallResult> plan(const ServiceContext& context, std::size_t index,
                                                 const CallMethodRequest& call);
    [[nodiscard]] std::optional<CallResult> carry_out(const ServiceContext& context,
                                                      std::size_t index,
                                                      const CallMethodRequest& call,
                                                      model::NodeIndex method);
    [[nodiscard]] Result<const MethodSignature*> signature(model::NodeIndex method);
    /// The result of a Method at any time; null if it has none.
    [[nodiscard]] const CallResult* find_result(std::size_t index) const;

    const MethodNeeds& needs_;
    SourceMethodCall call_;
    std::shared_ptr<Memory> memory_;
    std::unordered_map<model::NodeIndex, MethodSignature> signatures_;
    /// Signatures of the Methods that were passed to a source, null for others.
    std::vector<const MethodSignature*> asked_;
    /// Monitored items that the server's own Methods visited.
    std::size_t item_count_{0};
    /// References that may still be visited.
    std::size_t visits_left_{10'000'000};
    bool is_recorded_{false};
};

} // namespace busbar::server::detail
