#include "call_job.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <busbar/binary/codec.hpp>
#include <busbar/core/text.hpp>
#include <busbar/crypto/secret.hpp>

#include "server/data/read_results.hpp"
#include "server/rights/built_in_methods.hpp"
#include "server/rights/method_lookup.hpp"
#include "server/session/session.hpp"
#include "server/session/session_record.hpp"

namespace busbar::server::detail {

namespace {

/// Returns nothing if the inputs fit the Method (Part 4, 5.12.2.4).
std::optional<CallResult> check_inputs(const model::AddressSpace& space,
                                       std::span<const ArgumentRule> rules,
                                       std::span<const Variant> inputs)
{
    if (inputs.size() != rules.size()) {
        return CallResult{inputs.size() < rules.size() ? status::Bad_ArgumentsMissing
                                                       : status::Bad_TooManyArguments};
    }
    if (fit_arguments(space, rules, inputs)) {
        return std::nullopt;
    }
    CallResult refusal{status::Bad_InvalidArgument};
    refusal.input_results.reserve(inputs.size());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        refusal.input_results.push_back(check_argument(space, rules[i], inputs[i]));
    }
    return refusal;
}

/// Makes a source's result fit to be sent, since it may violate the protocol. False if its outputs
/// do not fit the Method.
bool tidy_result(const model::AddressSpace& space, const MethodSignature& signature,
                 CallResult& result)
{
    if (result.status != status::Bad_InvalidArgument ||
        result.input_results.size() != signature.inputs.size()) {
        result.input_results = {};
    }
    if (result.status.is_bad()) {
        result.outputs = {};
        return true;
    }
    if (result.status.is_good()) {
        result.status = status::Good; // Part 4, 5.12.2.4: no sub code
    }
    return fit_arguments(space, signature.outputs, result.outputs.span());
}

/// An output has no status of its own.
bool has_wrong_text(const CallResult& result)
{
    return !std::all_of(result.outputs.begin(), result.outputs.end(), has_valid_texts);
}

} // namespace

StatusCode check_call(const CallRequest& request, std::size_t max_methods)
{
    if (request.methods_to_call.empty()) {
        return status::Bad_NothingToDo;
    }
    return request.methods_to_call.size() > max_methods ? status::Bad_TooManyOperations
                                                        : status::Good;
}

std::size_t cost_of(const CallRequest& request)
{
    constexpr std::size_t bytes_per_method =
        sizeof(CallMethodRequest) + sizeof(CallItem) + sizeof(CallResult) + 64;
    std::size_t cost = 0;
    for (const CallMethodRequest& call : request.methods_to_call) {
        cost += bytes_per_method + call.input_arguments.size() * sizeof(Variant);
    }
    return cost;
}

CallJob::Memory::~Memory()
{
    const auto& calls = request.methods_to_call;
    if (std::any_of(calls.begin(), calls.end(), [](const CallMethodRequest& call) {
            return has_secret_inputs(call.method_id);
        })) {
        crypto::cleanse(message);
    }
}

CallJob::CallJob(const MethodNeeds& needs, const ServiceContext& context,
                 const CallRequest& request)
    : needs_{needs}, call_{needs.sources, request.methods_to_call.size()},
      memory_{std::make_shared<Memory>()}, asked_(request.methods_to_call.size())
{
    memory_->caller = {context.session->id,
                       context.session->user,
                       context.session->security.mode,
                       std::string{context.peer.address()},
                       context.mark.audit_entry_id,
                       context.mark.timestamp};
    const auto calls = request.methods_to_call.span();
    memory_->marks = std::make_unique<ResultMark[]>(calls.size());
    for (std::size_t i = 0; i < calls.size(); ++i) {
        if (auto answer = plan(context, i, calls[i])) {
            call_.answer(i) = std::move(*answer);
        }
    }
}

/// Returns nothing if a source will answer.
std::optional<CallResult> CallJob::plan(const ServiceContext& context, std::size_t index,
                                        const CallMethodRequest& call)
{
    const model::AddressSpace& space = needs_.space;
    const NodeRights rights = rights_of(*context.session, space, needs_.access);
    const auto method = find_method(space, rights, call.object_id, call.method_id, visits_left_);
    if (!method) {
        return CallResult{method.error()};
    }
    for (const model::NodeIndex node : {space.find(call.object_id), *method}) {
        if (const StatusCode weak = rights.check_channel(node); weak.is_bad()) {
            return CallResult{weak};
        }
    }
    if (!space.method(*method).executable) {
        return CallResult{status::Bad_NotExecutable};
    }
    if (!is_executable(space, *method)) {
        // A Method of an ObjectType itself has nothing to act on (SH-082679, 8.1).
        const bool is_type = space.node_class(space.find(call.object_id)) == NodeClass::ObjectType;
        return CallResult{is_type ? status::Bad_NotSupported : status::Bad_NotImplemented};
    }
    if (!is_user_executable(space, rights, *method)) {
        return CallResult{status::Bad_UserAccessDenied};
    }
    const auto needed = signature(*method);
    if (!needed) {
        return CallResult{needed.error()};
    }
    if (auto refusal = check_inputs(space, (*needed)->inputs, call.input_arguments.span())) {
        return refusal;
    }
    asked_[index] = *needed;
    return carry_out(context, index, call, *method);
}

std::optional<CallResult> CallJob::carry_out(const ServiceContext& context, std::size_t index,
                                             const CallMethodRequest& call, model::NodeIndex method)
{
    const model::AddressSpace& space = needs_.space;
    const model::MethodAttributes attributes = space.method(method);
    if (attributes.source == model::no_source) {
        // A short request must not keep the server busy for long.
        if (item_count_ >= needs_.limits.operations.max_monitored_items_per_call) {
            return CallResult{status::Bad_TooManyOperations};
        }
        return needs_.built_in.call(space.node_id(method), context, call.input_arguments.span(),
                                    item_count_);
    }
    const std::shared_ptr<SourceEntry>* const source = needs_.sources.find(attributes.source);
    if (source == nullptr) {
        return CallResult{status::Bad_NoCommunication};
    }
    if (needs_.state == ServerState::Shutdown && !(*source)->options().is_always_in_service) {
        return CallResult{status::Bad_Shutdown};
    }
    call_.ask(index, attributes.source,
              {attributes.handle, &call.object_id, &call.method_id, call.input_arguments.span(),
               &memory_->marks[index]});
    return std::nullopt;
}

Result<const MethodSignature*> CallJob::signature(model::NodeIndex method)
{
    const auto known = signatures_.find(method);
    if (known != signatures_.end()) {
        return &known->second;
    }
    auto read = read_signature(needs_.space, needs_.types, method);
    if (!read) {
        return fail(read.error());
    }
    return &signatures_.emplace(method, std::move(*read)).first->second;
}

bool CallJob::start(SourceCallOwner& owner, TimePoint now)
{
    call_.kept_for_sources() = memory_;
    return call_.start(owner, now, [this](CallPart& part) { part.caller = &memory_->caller; });
}

void CallJob::finish()
{
    for (std::size_t i = 0; i < asked_.size(); ++i) {
        CallResult* const result = asked_[i] != nullptr ? call_.find_answer(i) : nullptr;
        if (result == nullptr) {
            continue;
        }
        if (has_wrong_text(*result)) {
            *result = CallResult{status::Bad_EncodingError};
            needs_.log.write(LogLevel::Error, "method",
                             "a Method was answered with a text that is not UTF-8; the client gets "
                             "Bad_EncodingError");
        } else if (!tidy_result(needs_.space, *asked_[i], *result)) {
            *result = CallResult{status::Bad_InternalError};
            needs_.log.write(LogLevel::Error, "method",
                             "a Method was answered with outputs that are not those of its "
                             "OutputArguments; the client gets Bad_InternalError");
        }
    }
}

const CallResult* CallJob::find_result(std::size_t index) const
{
    const CallResult* const result = call_.find_result(index);
    return result == nullptr && memory_->marks[index].is_set ? &call_.settled_answer(index)
                                                             : result;
}

void CallJob::record(const Session& session, const RequestMark& mark, const CallRequest& request,
                     StatusCode status)
{
    if (std::exchange(is_recorded_, true) || !needs_.log.wants(RecordKind::MethodCalled)) {
        return;
    }
    for (std::size_t i = 0; i < call_.size(); ++i) {
        const CallMethodRequest& call = request.methods_to_call[i];
        const std::array fields{RecordField{"ObjectId", Variant{call.object_id}},
                                RecordField{"MethodId", Variant{call.method_id}},
                                RecordField{"InputArguments", Variant{call.input_arguments}}};
        Record one{RecordKind::MethodCalled, LogLevel::Debug, "method"};
        const CallResult* const result = find_result(i);
        one.status = result != nullptr ? result->status : status;
        if (const ResultMark& own = memory_->marks[i]; call_.has_failed(i) && own.is_set) {
            one.status = own.status; // it was done, although the client is told something else
        }
        one.text = result != nullptr ? result->reason : std::string{};
        one.actor = actor_of(session, mark);
        // The last field may contain a password.
        one.fields = std::span{fields}.first(has_secret_inputs(call.method_id) ? 2 : 3);
        needs_.log.record(one);
    }
}

void CallJob::keep(CallRequest request, std::vector<std::byte> message)
{
    // Moving the array and the buffer leaves their contents in place.
    memory_->request = std::move(request);
    memory_->message = std::move(message);
}

CallDiagnostics CallJob::diagnose(ReturnDiagnostics& diagnostics, const CallRequest& request) const
{
    CallDiagnostics all;
    if (!diagnostics.wants_operations()) {
        return all;
    }
    all.arguments.resize(call_.size());
    for (std::size_t i = 0; i < call_.size(); ++i) {
        const auto& inputs = call_.result(i).input_results;
        all.arguments[i] = diagnostics.of_operations(
            inputs.size(), [&](std::size_t input) { return inputs[input]; },
            [](std::size_t input) { return "input argument " + std::to_string(input); });
    }
    const bool is_encrypted = memory_->caller.security_mode == MessageSecurityMode::SignAndEncrypt;
    all.calls = diagnostics.of_operations(
        call_.size(), [&](std::size_t i) { return call_.result(i).status; },
        [&](std::size_t i) { return operand_text(request, i); },
        [&](std::size_t i) {
            return is_encrypted ? std::string_view{call_.result(i).reason} : std::string_view{};
        });
    return all;
}

void CallJob::encode_results(binary::Writer& writer, const CallDiagnostics& diagnostics) const
{
    writer.length(call_.size());
    for (std::size_t i = 0; i < call_.size(); ++i) {
        const CallResult& result = call_.result(i);
        encode(writer, result.status);
        encode(writer, result.input_results);
        encode(writer,
               diagnostics.arguments.empty() ? Array<DiagnosticInfo>{} : diagnostics.arguments[i]);
        encode(writer, result.outputs);
    }
    encode(writer, diagnostics.calls);
}

} // namespace busbar::server::detail
