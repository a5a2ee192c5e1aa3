#include "requests.hpp"

#include <cmath>
#include <limits>

namespace busbar::tool::rules {

namespace {
namespace reading {

ReadRequest read_of(std::vector<ReadValueId> items,
                    TimestampsToReturn timestamps = TimestampsToReturn::Both, double max_age = 0)
{
    ReadRequest request;
    request.nodes_to_read.assign(items.begin(), items.end());
    request.timestamps_to_return = timestamps;
    request.max_age = max_age;
    return request;
}

ReadValueId value_of(NodeId node, std::string_view range = {})
{
    return client::attribute_of(std::move(node), AttributeId::Value, range);
}

ReadValueId encoded(NodeId node, QualifiedName encoding, AttributeId attribute = AttributeId::Value)
{
    ReadValueId item = client::attribute_of(std::move(node), attribute);
    item.data_encoding = std::move(encoding);
    return item;
}

Result<ReadResponse> read(Subject& subject, ReadRequest request)
{
    return subject.ask<ReadResponse>(std::move(request));
}

/// The status of one item.
Answer one(Subject& subject, ReadValueId item)
{
    return operation_result(read(subject, read_of({std::move(item)})));
}

Answer attribute(Subject& subject, std::uint32_t node, AttributeId attribute)
{
    return one(subject, client::attribute_of(standard(node), attribute));
}

Answer with_number(Subject& subject, std::uint32_t attribute)
{
    ReadValueId item = value_of(some_scalar());
    item.attribute_id = attribute;
    return one(subject, std::move(item));
}

/// The only result of a Read, for `judge`.
template <typename Judge>
Answer judged(Subject& subject, ReadRequest request, Judge judge)
{
    return with(read(subject, std::move(request)), [&](const ReadResponse& response) {
        if (response.results.size() != 1) {
            return wrong(std::to_string(response.results.size()) + " results for one node");
        }
        return judge(response.results[0]);
    });
}

Answer timestamps(Subject& subject, TimestampsToReturn which, bool has_source, bool has_server)
{
    return judged(subject, read_of({value_of(some_scalar())}, which), [&](const DataValue& value) {
        const auto word = [](bool has) { return std::string{has ? "a" : "no"}; };
        const bool source = value.source_timestamp != DateTime{};
        const bool server = value.server_timestamp != DateTime{};
        return expect(source == has_source && server == has_server,
                      word(source) + " SourceTimestamp, " + word(server) + " ServerTimestamp");
    });
}

Answer no_timestamp_of_attribute(Subject& subject)
{
    return judged(subject,
                  read_of({client::attribute_of(some_scalar(), AttributeId::DisplayName)},
                          TimestampsToReturn::Source),
                  [](const DataValue& value) {
                      return expect(value.source_timestamp == DateTime{}, "a SourceTimestamp");
                  });
}

Answer first_element(Subject& subject)
{
    return judged(subject, read_of({value_of(some_array(), "0")}), [](const DataValue& value) {
        const auto* const uris = value.value.array_if<String>();
        return expect(uris != nullptr && uris->size() == 1,
                      uris == nullptr ? "no array of String"
                                      : std::to_string(uris->size()) + " elements");
    });
}

Answer range_beyond_end(Subject& subject)
{
    return judged(subject, read_of({value_of(some_array(), "0:99999")}),
                  [](const DataValue& value) {
                      const auto* const uris = value.value.array_if<String>();
                      return expect(value.status.is_good() && uris != nullptr && !uris->empty(),
                                    text_of(value.status));
                  });
}

Answer part_of_text(Subject& subject)
{
    return judged(
        subject,
        read_of({value_of(standard(id::Server_ServerStatus_BuildInfo_ManufacturerName), "0:1")}),
        [](const DataValue& value) {
            if (value.status == status::Bad_NodeIdUnknown ||
                value.status == status::Bad_IndexRangeNoData) {
                return not_applicable("the server does not say its manufacturer");
            }
            const auto* const text = value.value.get_if<String>();
            return expect(text != nullptr && text->size() <= 2,
                          text == nullptr ? "no String: " + text_of(value.status)
                                          : std::string{text->view()});
        });
}

Answer same_order(Subject& subject)
{
    const auto response =
        read(subject, read_of({value_of(some_array()), value_of(unknown_node()),
                               client::attribute_of(standard(id::Server), AttributeId::NodeClass),
                               value_of(some_scalar())}));
    return with(response, [](const ReadResponse& read) {
        if (read.results.size() != 4) {
            return wrong(std::to_string(read.results.size()) + " results for four nodes");
        }
        return expect(read.results[0].value.array_if<String>() != nullptr &&
                          read.results[1].status.is_bad() &&
                          read.results[2].value.get_if<std::int32_t>() != nullptr &&
                          read.results[3].value.get_if<DateTime>() != nullptr,
                      "results of other types than the nodes have");
    });
}

Answer too_many(Subject& subject)
{
    const std::uint32_t limit = subject.limits().max_nodes_per_read;
    if (limit == 0 || limit > 100'000) {
        return not_applicable("the server has no MaxNodesPerRead of at most 100,000");
    }
    return service_result(
        read(subject, read_of(std::vector<ReadValueId>(limit + 1, value_of(some_scalar())))));
}

/// The value of an attribute that is an enumeration or a number of its own C++ type.
template <typename T>
Answer has_type(Subject& subject, std::uint32_t node, AttributeId attribute)
{
    return judged(subject, read_of({client::attribute_of(standard(node), attribute)}),
                  [](const DataValue& value) {
                      return expect(value.value.get_if<T>() != nullptr,
                                    value.status.is_bad() ? text_of(value.status)
                                                          : "a value of another type");
                  });
}

Answer node_id_is_itself(Subject& subject)
{
    return judged(subject,
                  read_of({client::attribute_of(standard(id::Server), AttributeId::NodeId)}),
                  [](const DataValue& value) {
                      const auto* const node = value.value.get_if<NodeId>();
                      return expect(node != nullptr && node->is(id::Server),
                                    node == nullptr ? "no NodeId" : to_string(*node));
                  });
}

Answer unreadable(Subject& subject)
{
    return judged(subject, read_of({value_of(unknown_node())}), [](const DataValue& value) {
        return expect(value.value.is_null(), "a value beside " + text_of(value.status));
    });
}

Answer no_diagnostics(Subject& subject)
{
    return with(
        read(subject, read_of({value_of(unknown_node())})), [](const ReadResponse& response) {
            return expect(response.diagnostic_infos.empty(),
                          std::to_string(response.diagnostic_infos.size()) + " DiagnosticInfos");
        });
}

Answer same_node_twice(Subject& subject)
{
    return with(read(subject, read_of({value_of(some_scalar()), value_of(some_scalar())})),
                [](const ReadResponse& response) {
                    return expect(response.results.size() == 2,
                                  std::to_string(response.results.size()) + " results");
                });
}

constexpr Wanted node_unknown{status::Bad_NodeIdUnknown};
constexpr Wanted attribute_invalid{status::Bad_AttributeIdInvalid};
constexpr Wanted range_invalid{status::Bad_IndexRangeInvalid};
constexpr Wanted range_no_data{status::Bad_IndexRangeNoData};
constexpr const char* parameters = "Part 4, 5.11.2.2";
constexpr const char* results = "Part 4, 5.11.2.3";
constexpr const char* statuses = "Part 4, 5.11.2.4";
constexpr const char* ranges = "Part 4, 7.27";
/// Servers ignore the dataEncoding; those of earlier versions refuse one that does not fit.
constexpr const char* data_encoding = "Part 4, 7.28";

const SpecRule rules[] = {
    {"read-nothing", "Read", "A Read of nothing is refused", "nodesToRead = []",
     status::Bad_NothingToDo, results,
     [](Subject& subject) { return service_result(read(subject, read_of({}))); }},
    {"read-too-many", "Read", "More nodes than MaxNodesPerRead are refused",
     "MaxNodesPerRead + 1 nodes", status::Bad_TooManyOperations, results, too_many},
    {"read-max-age-negative", "Read", "A negative maxAge is refused", "maxAge = -1",
     status::Bad_MaxAgeInvalid, results,
     [](Subject& subject) {
         return service_result(
             read(subject, read_of({value_of(some_scalar())}, TimestampsToReturn::Both, -1)));
     }},
    {"read-max-age-large", "Read", "A large maxAge accepts any value", "maxAge = 2147483647",
     status::Good, parameters,
     [](Subject& subject) {
         return operation_result(
             read(subject, read_of({value_of(some_scalar())}, TimestampsToReturn::Both,
                                   std::numeric_limits<std::int32_t>::max())));
     }},
    {"read-timestamps-invalid", "Read", "Unknown timestampsToReturn are refused",
     "timestampsToReturn = 99", status::Bad_TimestampsToReturnInvalid, results,
     [](Subject& subject) {
         return service_result(read(
             subject, read_of({value_of(some_scalar())}, static_cast<TimestampsToReturn>(99))));
     }},
    {"read-timestamps-invalid-enumerator", "Read", "timestampsToReturn Invalid is refused",
     "timestampsToReturn = Invalid (4)", status::Bad_TimestampsToReturnInvalid, "Part 4, 7.39",
     [](Subject& subject) {
         return service_result(
             read(subject, read_of({value_of(some_scalar())}, TimestampsToReturn::Invalid)));
     }},
    {"read-timestamps-source", "Read", "Source returns the SourceTimestamp alone",
     "timestampsToReturn = Source", "only a SourceTimestamp", parameters,
     [](Subject& subject) { return timestamps(subject, TimestampsToReturn::Source, true, false); }},
    {"read-timestamps-server", "Read", "Server returns the ServerTimestamp alone",
     "timestampsToReturn = Server", "only a ServerTimestamp", parameters,
     [](Subject& subject) { return timestamps(subject, TimestampsToReturn::Server, false, true); }},
    {"read-timestamps-both", "Read", "Both returns both timestamps", "timestampsToReturn = Both",
     "both timestamps", parameters,
     [](Subject& subject) { return timestamps(subject, TimestampsToReturn::Both, true, true); }},
    {"read-timestamps-neither", "Read", "Neither returns no timestamp",
     "timestampsToReturn = Neither", "no timestamp", parameters,
     [](Subject& subject) {
         return timestamps(subject, TimestampsToReturn::Neither, false, false);
     }},
    {"read-timestamp-of-attribute", "Read", "An attribute other than Value has no SourceTimestamp",
     "DisplayName, timestampsToReturn = Source", "no SourceTimestamp", "Part 4, 7.11.3",
     no_timestamp_of_attribute},
    {"read-node-unknown", "Read", "A node that is not there is unknown",
     "a NodeId that does not exist", node_unknown, statuses,
     [](Subject& subject) { return one(subject, value_of(unknown_node())); }},
    {"read-node-null", "Read", "The null NodeId is not a node", "nodeId = null",
     one_of(status::Bad_NodeIdUnknown, status::Bad_NodeIdInvalid), statuses,
     [](Subject& subject) { return one(subject, value_of(NodeId{})); }},
    {"read-namespace-unknown", "Read", "A node of an unknown namespace is unknown",
     "a node of namespace 65535", one_of(status::Bad_NodeIdUnknown, status::Bad_NodeIdInvalid),
     statuses,
     [](Subject& subject) {
         return one(subject, value_of(NodeId{65'535, 1U}));
     }},
    {"read-node-unknown-has-no-value", "Read", "A node that is not there has no value",
     "a NodeId that does not exist", "no value beside the status", "Part 4, 7.11.1", unreadable},
    {"read-attribute-zero", "Read", "There is no attribute 0", "attributeId = 0", attribute_invalid,
     statuses, [](Subject& subject) { return with_number(subject, 0); }},
    {"read-attribute-unknown", "Read", "There is no attribute 999", "attributeId = 999",
     attribute_invalid, statuses, [](Subject& subject) { return with_number(subject, 999); }},
    {"read-value-of-object", "Read", "An Object has no Value", "Value of Server", attribute_invalid,
     statuses, [](Subject& subject) { return attribute(subject, id::Server, AttributeId::Value); }},
    {"read-executable-of-variable", "Read", "A Variable is not Executable",
     "Executable of CurrentTime", attribute_invalid, statuses,
     [](Subject& subject) {
         return attribute(subject, id::Server_ServerStatus_CurrentTime, AttributeId::Executable);
     }},
    {"read-symmetric-of-object", "Read", "An Object is not Symmetric", "Symmetric of Server",
     attribute_invalid, statuses,
     [](Subject& subject) { return attribute(subject, id::Server, AttributeId::Symmetric); }},
    {"read-event-notifier-of-variable", "Read", "A Variable has no EventNotifier",
     "EventNotifier of CurrentTime", attribute_invalid, statuses,
     [](Subject& subject) {
         return attribute(subject, id::Server_ServerStatus_CurrentTime, AttributeId::EventNotifier);
     }},
    {"read-node-id", "Read", "A node knows its NodeId", "NodeId of Server", "i=2253",
     "Part 3, 5.2.2", node_id_is_itself},
    {"read-node-class-type", "Read", "A NodeClass is an Int32", "NodeClass of Server", "an Int32",
     "Part 6, 5.2.4",
     [](Subject& subject) {
         return has_type<std::int32_t>(subject, id::Server, AttributeId::NodeClass);
     }},
    {"read-browse-name-type", "Read", "A BrowseName is a QualifiedName", "BrowseName of Server",
     "a QualifiedName", "Part 3, 5.2.4",
     [](Subject& subject) {
         return has_type<QualifiedName>(subject, id::Server, AttributeId::BrowseName);
     }},
    {"read-event-notifier-type", "Read", "An EventNotifier is a Byte", "EventNotifier of Server",
     "a Byte", "Part 3, 5.5.1",
     [](Subject& subject) {
         return has_type<std::uint8_t>(subject, id::Server, AttributeId::EventNotifier);
     }},
    {"read-value-rank-type", "Read", "A ValueRank is an Int32", "ValueRank of CurrentTime",
     "an Int32", "Part 3, 5.6.2",
     [](Subject& subject) {
         return has_type<std::int32_t>(subject, id::Server_ServerStatus_CurrentTime,
                                       AttributeId::ValueRank);
     }},
    {"read-range-syntax", "Read", "A range of letters is invalid", "indexRange = \"x\"",
     range_invalid, ranges,
     [](Subject& subject) { return one(subject, value_of(some_array(), "x")); }},
    {"read-range-blank", "Read", "A blank is not allowed in a range", "indexRange = \"0: 1\"",
     range_invalid, ranges,
     [](Subject& subject) { return one(subject, value_of(some_array(), "0: 1")); }},
    {"read-range-equal", "Read", "The bounds of a range are not equal", "indexRange = \"0:0\"",
     range_invalid, ranges,
     [](Subject& subject) { return one(subject, value_of(some_array(), "0:0")); }},
    {"read-range-descending", "Read", "A range ascends", "indexRange = \"1:0\"", range_invalid,
     ranges, [](Subject& subject) { return one(subject, value_of(some_array(), "1:0")); }},
    {"read-range-negative", "Read", "A negative index is invalid", "indexRange = \"-1\"",
     range_invalid, ranges,
     [](Subject& subject) { return one(subject, value_of(some_array(), "-1")); }},
    {"read-range-no-data", "Read", "An element beyond the end has no data",
     "indexRange = \"99999\"", range_no_data, ranges,
     [](Subject& subject) { return one(subject, value_of(some_array(), "99999")); }},
    {"read-range-partly", "Read", "A range that begins within the array returns what is there",
     "indexRange = \"0:99999\"", "a part of the array", ranges, range_beyond_end},
    {"read-range-dimensions", "Read", "An array of String has no third dimension",
     "indexRange = \"0,0,0\" of an array of String", range_no_data, ranges,
     [](Subject& subject) { return one(subject, value_of(some_array(), "0,0,0")); }},
    {"read-range-of-scalar", "Read", "A scalar has no elements", "indexRange = \"0\" of a scalar",
     range_no_data, ranges,
     [](Subject& subject) { return one(subject, value_of(some_scalar(), "0")); }},
    {"read-range-element", "Read", "One element of an array is an array of one",
     "indexRange = \"0\"", "an array with one element", ranges, first_element},
    {"read-range-of-text", "Read", "A range of a String is a part of it",
     "ManufacturerName, indexRange = \"0:1\"", "at most two characters", ranges, part_of_text},
    {"read-encoding-of-scalar", "Read", "The encoding of a scalar is ignored or refused",
     "CurrentTime, dataEncoding = \"Default Binary\"",
     one_of(status::Good, status::Bad_DataEncodingInvalid), data_encoding,
     [](Subject& subject) {
         return one(subject, encoded(some_scalar(), QualifiedName{0, "Default Binary"}));
     }},
    {"read-encoding-unknown", "Read", "An unknown encoding is ignored or refused",
     "ServerStatus, dataEncoding = \"None Such\"",
     one_of(status::Good, status::Bad_DataEncodingInvalid, status::Bad_DataEncodingUnsupported),
     data_encoding,
     [](Subject& subject) {
         return one(subject,
                    encoded(standard(id::Server_ServerStatus), QualifiedName{0, "None Such"}));
     }},
    {"read-encoding-of-attribute", "Read", "The encoding of a DisplayName is ignored or refused",
     "DisplayName, dataEncoding = \"Default Binary\"",
     one_of(status::Good, status::Bad_DataEncodingInvalid), data_encoding,
     [](Subject& subject) {
         return one(subject, encoded(some_scalar(), QualifiedName{0, "Default Binary"},
                                     AttributeId::DisplayName));
     }},
    {"read-encoding-binary", "Read", "Default Binary is an encoding of structures",
     "ServerStatus, dataEncoding = \"Default Binary\"", status::Good, data_encoding,
     [](Subject& subject) {
         return one(subject,
                    encoded(standard(id::Server_ServerStatus), QualifiedName{0, "Default Binary"}));
     }},
    {"read-order", "Read", "Results are in the order of the request",
     "four nodes, one of them unknown", "four results in their order", parameters, same_order},
    {"read-twice", "Read", "A node can be read twice in a request", "CurrentTime twice",
     "two results", parameters, same_node_twice},
    {"read-no-diagnostics", "Read", "No DiagnosticInfo comes unasked",
     "returnDiagnostics = 0, an unknown node", "no DiagnosticInfo", parameters, no_diagnostics},
};

} // namespace reading
} // namespace

std::span<const SpecRule> read_rules()
{
    return reading::rules;
}

} // namespace busbar::tool::rules
