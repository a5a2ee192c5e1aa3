#include <busbar/types/method.hpp>

#include "requests.hpp"

namespace busbar::tool::rules {

namespace {
namespace values {

Result<WriteResponse> write(Subject& subject, Array<WriteValue> items)
{
    WriteRequest request;
    request.nodes_to_write = std::move(items);
    return subject.ask<WriteResponse>(std::move(request));
}

Answer one(Subject& subject, WriteValue item)
{
    return operation_result(write(subject, {std::move(item)}));
}

DataValue read(Subject& subject, const NodeId& node)
{
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Source;
    request.nodes_to_read = {client::attribute_of(node)};
    auto response = subject.ask<ReadResponse>(std::move(request));
    if (!response || response->results.size() != 1) {
        throw Refused{response ? status::Bad_UnexpectedError : response.error(), "Read"};
    }
    return std::move(response->results[0]);
}

/// Writes the value that the node had, without status and times.
Answer write_back(Subject& subject)
{
    return one(subject,
               client::value_for(subject.writable().id, DataValue{subject.writable().value.value}));
}

/// Gives the user's node its value again, however the rule that wrote another one ends.
class Restored {
public:
    explicit Restored(Subject& subject) : subject_{&subject} {}
    Restored(const Restored&) = delete;
    Restored& operator=(const Restored&) = delete;
    ~Restored()
    {
        if (subject_ == nullptr) {
            return;
        }
        try {
            subject_->begin(); // if the time of the rule is over, too
            static_cast<void>(write_back(*subject_));
        } catch (const NoAnswer&) {
            // The verdict is there already; the next rule meets a lost session by itself.
        } catch (const Unreachable&) {
            // The next rule meets that by itself, too.
        }
    }

    /// Keeps the destructor from writing, since nothing was written.
    void forget() { subject_ = nullptr; }

private:
    Subject* subject_;
};

/// A write to the user's node that has to fail; the value is restored if it does not.
Answer refused(Subject& subject, DataValue value, std::string_view range = {})
{
    Restored restored{subject};
    Answer answer = one(subject, client::value_for(subject.writable().id, std::move(value),
                                                   AttributeId::Value, range));
    if (answer.kind == Answer::Kind::Status && answer.status.is_bad()) {
        restored.forget();
    }
    return answer;
}

/// A value of a type that the node does not have.
Variant of_other_type(const Subject& subject)
{
    return subject.writable().value.value.type() == BuiltInType::Guid ? Variant{true}
                                                                      : Variant{Guid{}};
}

Answer written_and_read(Subject& subject)
{
    Answer answer = write_back(subject);
    if (answer.kind != Answer::Kind::Status || answer.status.is_bad()) {
        return answer;
    }
    return expect(read(subject, subject.writable().id).value == subject.writable().value.value,
                  "another value");
}

Answer with_status(Subject& subject)
{
    DataValue value{subject.writable().value.value};
    value.status = status::Uncertain_LastUsableValue;
    const Restored restored{subject};
    Answer answer = one(subject, client::value_for(subject.writable().id, value));
    if (answer.kind == Answer::Kind::Status && answer.status.is_good()) {
        const StatusCode status = read(subject, subject.writable().id).status;
        return expect(status.is_uncertain(), "the status read is " + text_of(status));
    }
    if (answer.status == status::Bad_WriteNotSupported) {
        return right();
    }
    return answer;
}

Answer with_times(Subject& subject)
{
    DataValue value{subject.writable().value.value};
    value.server_timestamp = DateTime{DateTime::unix_epoch};
    const Restored restored{subject};
    return one(subject, client::value_for(subject.writable().id, value));
}

Answer each_its_result(Subject& subject)
{
    const auto response =
        write(subject, {client::value_for(unknown_node(), DataValue{Variant{1}}),
                        client::value_for(standard(id::Server), DataValue{Variant{1}})});
    return with(response, [](const WriteResponse& each) {
        return expect(each.results.size() == 2 && each.results[0] == status::Bad_NodeIdUnknown &&
                          each.results[1].is_bad(),
                      std::to_string(each.results.size()) + " results, or others");
    });
}

Answer too_many(Subject& subject)
{
    const std::uint32_t limit = subject.limits().max_nodes_per_write;
    if (limit == 0 || limit > 100'000) {
        return not_applicable("the server has no MaxNodesPerWrite of at most 100,000");
    }
    Array<WriteValue> items(limit + 1);
    for (WriteValue& item : items) {
        item = client::value_for(unknown_node(), DataValue{Variant{1}});
    }
    return service_result(write(subject, std::move(items)));
}

Result<CallResponse> call(Subject& subject, Array<CallMethodRequest> methods)
{
    CallRequest request;
    request.methods_to_call = std::move(methods);
    return subject.ask<CallResponse>(std::move(request));
}

Answer called(Subject& subject, NodeId object, NodeId method, Array<Variant> arguments = {})
{
    CallMethodRequest request;
    request.object_id = std::move(object);
    request.method_id = std::move(method);
    request.input_arguments = std::move(arguments);
    return operation_result(call(subject, {std::move(request)}));
}

/// A call of GetMonitoredItems of an Object, where the server has the Method.
Answer get_items(Subject& subject, Array<Variant> arguments, NodeId object = standard(id::Server))
{
    ReadRequest request;
    request.nodes_to_read = {
        client::attribute_of(standard(id::Server_GetMonitoredItems), AttributeId::NodeClass)};
    const auto response = subject.ask<ReadResponse>(std::move(request));
    if (!response || response->results.size() != 1 || response->results[0].status.is_bad()) {
        return not_applicable("the server does not have GetMonitoredItems");
    }
    return called(subject, std::move(object), standard(id::Server_GetMonitoredItems),
                  std::move(arguments));
}

/// The response to a Read whose encoding `encode` writes after the header.
Answer encoded(Subject& subject, FunctionRef<void(binary::Writer&)> encode_body)
{
    Line& line = subject.session();
    const std::uint32_t handle =
        line.send_encoded([&](binary::Writer& writer, const RequestHeader& header) {
            encode(writer, NodeId{0, ReadRequest::binary_encoding_id});
            encode(writer, header);
            encode_body(writer);
        });
    return operation_result(line.wait_for<ReadResponse>(handle));
}

void begin_read(binary::Writer& writer, std::int32_t count)
{
    encode(writer, 0.0);
    encode(writer, static_cast<std::int32_t>(TimestampsToReturn::Both));
    encode(writer, count);
}

Answer null_array(Subject& subject)
{
    return encoded(subject, [](binary::Writer& writer) { begin_read(writer, -1); });
}

/// A Read of CurrentTime with its NodeId in another form, and empty texts instead of null ones.
Answer node_form(Subject& subject, std::span<const std::uint8_t> node)
{
    return encoded(subject, [&](binary::Writer& writer) {
        begin_read(writer, 1);
        writer.numbers(node);
        encode(writer, static_cast<std::uint32_t>(AttributeId::Value));
        encode(writer, String{""});
        encode(writer, QualifiedName{0, String{""}});
    });
}

Answer header_strings(Subject& subject)
{
    ReadRequest request;
    request.nodes_to_read = {client::attribute_of(some_scalar())};
    return operation_result(subject.ask<ReadResponse>(
        std::move(request), [](RequestHeader& header) { header.audit_entry_id = ""; }));
}

Answer truncated(Subject& subject)
{
    return encoded(subject, [](binary::Writer& writer) { begin_read(writer, 1); });
}

Answer too_long_array(Subject& subject)
{
    return encoded(subject, [](binary::Writer& writer) { begin_read(writer, 0x7FFF'FFFF); });
}

Answer unknown_service(Subject& subject)
{
    Line& line = subject.session();
    const std::uint32_t handle =
        line.send_encoded([](binary::Writer& writer, const RequestHeader& header) {
            encode(writer, standard(0x7FFF'FFF0U));
            encode(writer, header);
        });
    const auto fault = line.fault_of(handle);
    return fault ? came(fault->response_header.service_result) : wrong("no ServiceFault");
}

Answer structure_encoding(Subject& subject)
{
    const DataValue value = read(subject, standard(id::Server_ServerStatus));
    const auto* const object = value.value.get_if<ExtensionObject>();
    if (object == nullptr) {
        return wrong("no structure");
    }
    return expect(object->encoding_id().is(id::ServerStatusDataType_Encoding_DefaultBinary),
                  to_string(object->encoding_id()));
}

Answer diagnostic_texts(Subject& subject)
{
    constexpr std::uint32_t operation_texts = 0x3FFU;
    ReadRequest request;
    request.nodes_to_read = {client::attribute_of(unknown_node()),
                             client::attribute_of(some_scalar())};
    const auto response = subject.ask<ReadResponse>(std::move(request), [](RequestHeader& header) {
        header.return_diagnostics = operation_texts;
    });
    return with(response, [](const ReadResponse& each) {
        const std::size_t size = each.diagnostic_infos.size();
        if (size == 0) {
            return not_applicable("the server returns no DiagnosticInfo");
        }
        const auto texts = static_cast<std::int64_t>(each.response_header.string_table.size());
        for (const DiagnosticInfo& info : each.diagnostic_infos) {
            if (info.symbolic_id.value_or(-1) >= texts ||
                info.localized_text.value_or(-1) >= texts) {
                return wrong("an index beyond the stringTable");
            }
        }
        return expect(size == 2, std::to_string(size) + " for two nodes");
    });
}

constexpr const char* writing = "Part 4, 5.11.4.4";
constexpr const char* calling = "Part 4, 5.12.2.4";
constexpr std::array<std::uint8_t, 4> four_bytes = {1, 0, 0xD2, 0x08};
constexpr std::array<std::uint8_t, 7> numeric = {2, 0, 0, 0xD2, 0x08, 0, 0};

const SpecRule rules[] = {
    {"write-nothing", "Write", "A Write of nothing is refused", "nodesToWrite = []",
     status::Bad_NothingToDo, "Part 4, 5.11.4.3",
     [](Subject& subject) { return service_result(write(subject, {})); }},
    {"write-too-many", "Write", "More nodes than MaxNodesPerWrite are refused",
     "MaxNodesPerWrite + 1 nodes that do not exist", status::Bad_TooManyOperations,
     "Part 4, 5.11.4.3", too_many},
    {"write-node-unknown", "Write", "A node that is not there is unknown",
     "a NodeId that does not exist", status::Bad_NodeIdUnknown, writing,
     [](Subject& subject) {
         return one(subject, client::value_for(unknown_node(), DataValue{Variant{1}}));
     }},
    {"write-attribute-invalid", "Write", "An Object has no Value", "Value of Server",
     one_of(status::Bad_AttributeIdInvalid, status::Bad_UserAccessDenied), writing,
     [](Subject& subject) {
         return one(subject, client::value_for(standard(id::Server), DataValue{Variant{1}}));
     }},
    {"write-read-only", "Write", "A Variable that is only read is not written", "CurrentTime",
     one_of(status::Bad_NotWritable, status::Bad_UserAccessDenied), writing,
     [](Subject& subject) {
         return one(subject, client::value_for(some_scalar(), DataValue{Variant{DateTime{}}}));
     }},
    {"write-node-class", "Write", "A NodeClass is never written", "NodeClass of Server",
     one_of(status::Bad_NotWritable, status::Bad_UserAccessDenied, status::Bad_WriteNotSupported),
     writing,
     [](Subject& subject) {
         return one(subject, client::value_for(standard(id::Server), DataValue{Variant{1}},
                                               AttributeId::NodeClass));
     }},
    {"write-results", "Write", "Each node has its result", "two nodes that cannot be written",
     "two bad results", "Part 4, 5.11.4.2", each_its_result},
    {"write-value", "Write", "A value is written and read", "the value that it had",
     "the same value", "Part 4, 5.11.4.1", written_and_read, RuleNeed::Writable},
    {"write-type", "Write", "A value of another type is refused", "a Guid",
     status::Bad_TypeMismatch, writing,
     [](Subject& subject) { return refused(subject, DataValue{of_other_type(subject)}); },
     RuleNeed::Writable},
    {"write-range-syntax", "Write", "A range of letters is invalid", "indexRange = \"x\"",
     status::Bad_IndexRangeInvalid, writing,
     [](Subject& subject) {
         return refused(subject, DataValue{subject.writable().value.value}, "x");
     },
     RuleNeed::Writable},
    {"write-status", "Write", "A status is written, or refused", "Uncertain_LastUsableValue",
     "the status read is Uncertain, or Bad_WriteNotSupported", "Part 4, 5.11.4.1", with_status,
     RuleNeed::Writable},
    {"write-server-timestamp", "Write", "A ServerTimestamp is written or refused",
     "serverTimestamp = 1970", one_of(status::Good, status::Bad_WriteNotSupported),
     "Part 4, 5.11.4.2", with_times, RuleNeed::Writable},
    {"call-nothing", "Call", "A Call of nothing is refused", "methodsToCall = []",
     status::Bad_NothingToDo, "Part 4, 5.12.2.3",
     [](Subject& subject) { return service_result(call(subject, {})); }},
    {"call-object-unknown", "Call", "An Object that is not there is unknown",
     "objectId = a NodeId that does not exist", status::Bad_NodeIdUnknown, calling,
     [](Subject& subject) { return get_items(subject, {}, unknown_node()); }},
    {"call-method-unknown", "Call", "A Method that is not there is invalid",
     "methodId = a NodeId that does not exist",
     one_of(status::Bad_MethodInvalid, status::Bad_NodeIdUnknown), calling,
     [](Subject& subject) { return called(subject, standard(id::Server), unknown_node()); }},
    {"call-variable", "Call", "A Variable is not a Method", "methodId = CurrentTime",
     status::Bad_MethodInvalid, calling,
     [](Subject& subject) { return called(subject, standard(id::Server), some_scalar()); }},
    {"call-arguments-missing", "Call", "An argument that is missing is told",
     "GetMonitoredItems without arguments", status::Bad_ArgumentsMissing, calling,
     [](Subject& subject) { return get_items(subject, {}); }},
    {"call-arguments-many", "Call", "An argument too many is told",
     "GetMonitoredItems with two arguments", status::Bad_TooManyArguments, calling,
     [](Subject& subject) {
         return get_items(subject, {Variant{std::uint32_t{1}}, Variant{std::uint32_t{1}}});
     }},
    {"call-arguments-type", "Call", "An argument of another type is invalid",
     "GetMonitoredItems with a String", status::Bad_InvalidArgument, calling,
     [](Subject& subject) { return get_items(subject, {Variant{"text"}}); }},
    {"call-subscription-unknown", "Call", "GetMonitoredItems knows its Subscriptions",
     "GetMonitoredItems with 4294967280", status::Bad_SubscriptionIdInvalid, "Part 5, 9.1",
     [](Subject& subject) { return get_items(subject, {Variant{std::uint32_t{0xFFFF'FFF0U}}}); }},
    {"encoding-null-array", "Read", "An array of length -1 is empty", "nodesToRead: length -1",
     status::Bad_NothingToDo, "Part 6, 5.1.11", null_array},
    {"encoding-node-four-bytes", "Read", "A NodeId may take four bytes", "01 00 D2 08",
     status::Good, "Part 6, 5.2.2.9",
     [](Subject& subject) { return node_form(subject, four_bytes); }},
    {"encoding-node-numeric", "Read", "A NodeId with more bytes than it needs is read or refused",
     "02 00 00 D2 08 00 00", one_of(status::Good, status::Bad_DecodingError), "Part 6, 5.2.2.9",
     [](Subject& subject) { return node_form(subject, numeric); }},
    {"encoding-empty-string", "Read", "An empty String is not an error", "auditEntryId = \"\"",
     status::Good, "Part 6, 5.1.11", header_strings},
    {"encoding-truncated", "Read", "A body that ends too early is a fault",
     "nodesToRead of length 1, then the end", status::Bad_DecodingError, "Part 4, 5.3", truncated},
    {"encoding-length", "Read", "A length beyond the message is a fault",
     "nodesToRead of length 2147483647",
     one_of(status::Bad_DecodingError, status::Bad_EncodingLimitsExceeded,
            status::Bad_TooManyOperations),
     "Part 4, 5.3", too_long_array},
    {"encoding-service-unknown", "Read", "A request of an unknown type is a fault", "i=2147483632",
     one_of(status::Bad_ServiceUnsupported, status::Bad_DecodingError), "Part 4, 7.38.2",
     unknown_service},
    {"encoding-structure", "Read", "A structure has the NodeId of its encoding", "ServerStatus",
     "i=864", "Part 6, 5.2.2.15", structure_encoding},
    {"encoding-diagnostics", "Read", "DiagnosticInfos point into the stringTable",
     "returnDiagnostics = 1023, two nodes", "two of them, or none", "Part 4, 7.12",
     diagnostic_texts},
};

} // namespace values
} // namespace

std::span<const SpecRule> value_rules()
{
    return values::rules;
}

} // namespace busbar::tool::rules
