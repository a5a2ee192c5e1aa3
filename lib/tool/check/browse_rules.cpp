#include "requests.hpp"

namespace busbar::tool::rules {

namespace {
namespace walking {

constexpr std::uint32_t all_fields = 63;

BrowseDescription children(NodeId node)
{
    BrowseDescription description;
    description.node_id = std::move(node);
    description.browse_direction = BrowseDirection::Forward;
    description.reference_type_id = standard(id::HierarchicalReferences);
    description.include_subtypes = true;
    description.result_mask = all_fields;
    return description;
}

BrowseRequest browse_of(std::vector<BrowseDescription> nodes, std::uint32_t max_references = 0)
{
    BrowseRequest request;
    request.nodes_to_browse.assign(nodes.begin(), nodes.end());
    request.requested_max_references_per_node = max_references;
    return request;
}

Result<BrowseResponse> browse(Subject& subject, BrowseRequest request)
{
    return subject.ask<BrowseResponse>(std::move(request));
}

Answer one(Subject& subject, BrowseDescription description)
{
    return operation_result(browse(subject, browse_of({std::move(description)})));
}

/// The only result of a Browse, for `judge`.
template <typename Judge>
Answer judged(Subject& subject, BrowseRequest request, Judge judge)
{
    return with(browse(subject, std::move(request)), [&](const BrowseResponse& response) {
        if (response.results.size() != 1 || response.results[0].status_code.is_bad()) {
            return wrong(response.results.size() != 1
                             ? std::to_string(response.results.size()) + " results for one node"
                             : text_of(response.results[0].status_code));
        }
        return judge(response.results[0]);
    });
}

Result<BrowseNextResponse> next(Subject& subject, const ByteString& point, bool releases = false)
{
    BrowseNextRequest request;
    request.release_continuation_points = releases;
    request.continuation_points = {point};
    return subject.ask<BrowseNextResponse>(std::move(request));
}

/// Judges the continuation point that a Browse of the Server for one reference has to return, as
/// the Server has more children.
template <typename Judge>
Answer continued(Subject& subject, Judge judge)
{
    return judged(subject, browse_of({children(standard(id::Server))}, 1),
                  [&](const BrowseResult& result) {
                      if (result.continuation_point.empty()) {
                          return wrong("no continuation point for the other references");
                      }
                      return judge(result);
                  });
}

std::string count_of(std::size_t count)
{
    return std::to_string(count) + " references";
}

Answer one_reference(Subject& subject)
{
    return continued(subject, [&](const BrowseResult& result) {
        static_cast<void>(next(subject, result.continuation_point, true));
        return expect(result.references.size() == 1, count_of(result.references.size()));
    });
}

Answer all_by_next(Subject& subject)
{
    std::size_t wanted = 0;
    const Answer whole = judged(
        subject, browse_of({children(standard(id::Server))}), [&](const BrowseResult& result) {
            wanted = result.references.size();
            return expect(result.continuation_point.empty(), "not all references at once");
        });
    if (whole.kind != Answer::Kind::Right) {
        return not_applicable("Server has more references than the server returns at once");
    }
    return continued(subject, [&](const BrowseResult& first) {
        std::size_t found = first.references.size();
        ByteString point = first.continuation_point;
        while (!point.empty() && found <= wanted) {
            const auto response = next(subject, point);
            if (!response || response->results.size() != 1) {
                return wrong(response ? "not one result" : text_of(response.error()));
            }
            found += response->results[0].references.size();
            point = response->results[0].continuation_point;
        }
        return expect(found == wanted, std::to_string(found) + " of " + count_of(wanted));
    });
}

Answer released(Subject& subject)
{
    return continued(subject, [&](const BrowseResult& result) {
        const auto response = next(subject, result.continuation_point, true);
        if (!response) {
            return came(response.error());
        }
        return operation_result(next(subject, result.continuation_point));
    });
}

Answer release_returns_nothing(Subject& subject)
{
    return continued(subject, [&](const BrowseResult& result) {
        return with(next(subject, result.continuation_point, true),
                    [](const BrowseNextResponse& response) {
                        std::size_t references = 0;
                        for (const BrowseResult& each : response.results) {
                            references += each.references.size();
                        }
                        return expect(references == 0, count_of(references));
                    });
    });
}

Answer of_other_session(Subject& subject)
{
    return continued(subject, [&](const BrowseResult& result) {
        Line other = subject.other_session();
        BrowseNextRequest request;
        request.continuation_points = {result.continuation_point};
        Answer answer = operation_result(other.ask<BrowseNextResponse>(std::move(request)));
        other.close();
        static_cast<void>(next(subject, result.continuation_point, true));
        return answer;
    });
}

/// Uses the last continuation point twice: until then a server may continue with the same one.
Answer used_twice(Subject& subject)
{
    return continued(subject, [&](const BrowseResult& result) {
        ByteString point = result.continuation_point;
        for (;;) {
            const auto response = next(subject, point);
            if (!response || response->results.size() != 1 ||
                response->results[0].status_code.is_bad()) {
                return wrong("BrowseNext failed");
            }
            const ByteString& following = response->results[0].continuation_point;
            if (following.empty()) {
                return operation_result(next(subject, point));
            }
            point = following;
        }
    });
}

Answer only_classes(Subject& subject)
{
    BrowseDescription description = children(standard(id::Server));
    description.node_class_mask = static_cast<std::uint32_t>(NodeClass::Variable);
    return judged(subject, browse_of({std::move(description)}), [](const BrowseResult& result) {
        for (const ReferenceDescription& each : result.references) {
            if (each.node_class != NodeClass::Variable) {
                return wrong(to_string(each.browse_name) + " is of another class");
            }
        }
        return expect(!result.references.empty(), "no reference");
    });
}

Answer only_asked_fields(Subject& subject)
{
    BrowseDescription description = children(standard(id::Server));
    description.result_mask = 0;
    return judged(subject, browse_of({std::move(description)}), [](const BrowseResult& result) {
        for (const ReferenceDescription& each : result.references) {
            if (!each.browse_name.is_null() || !each.display_name.text.empty() ||
                !each.reference_type_id.is_null() || each.node_class != NodeClass{} ||
                !each.type_definition.node_id.is_null()) {
                return wrong("fields that were not asked for");
            }
        }
        return expect(!result.references.empty(), "no reference");
    });
}

Answer inverse_only(Subject& subject)
{
    BrowseDescription description = children(standard(id::Server));
    description.browse_direction = BrowseDirection::Inverse;
    return judged(subject, browse_of({std::move(description)}), [](const BrowseResult& result) {
        bool has_objects = false;
        for (const ReferenceDescription& each : result.references) {
            if (each.is_forward) {
                return wrong("a forward reference to " + to_string(each.browse_name));
            }
            has_objects = has_objects || each.node_id.node_id.is(id::ObjectsFolder);
        }
        return expect(has_objects, "no reference from Objects");
    });
}

Answer exact_type(Subject& subject)
{
    BrowseDescription description = children(standard(id::Server));
    description.include_subtypes = false;
    return judged(subject, browse_of({std::move(description)}), [](const BrowseResult& result) {
        return expect(result.references.empty(), count_of(result.references.size()));
    });
}

Answer any_type(Subject& subject)
{
    BrowseDescription description = children(standard(id::Server));
    description.reference_type_id = NodeId{};
    return judged(subject, browse_of({std::move(description)}), [](const BrowseResult& result) {
        for (const ReferenceDescription& each : result.references) {
            if (each.reference_type_id.is(id::HasTypeDefinition)) {
                return right();
            }
        }
        return wrong("no HasTypeDefinition");
    });
}

Answer view(Subject& subject, NodeId node)
{
    BrowseRequest request = browse_of({children(standard(id::ObjectsFolder))});
    request.view.view_id = std::move(node);
    const auto response = browse(subject, std::move(request));
    return response ? operation_result(response) : service_result(response);
}

Answer too_many(Subject& subject)
{
    const std::uint32_t limit = subject.limits().max_nodes_per_browse;
    if (limit == 0 || limit > 100'000) {
        return not_applicable("the server has no MaxNodesPerBrowse of at most 100,000");
    }
    return service_result(browse(
        subject, browse_of(std::vector<BrowseDescription>(limit + 1, children(unknown_node())))));
}

Result<TranslateBrowsePathsToNodeIdsResponse> translate(Subject& subject, Array<BrowsePath> paths)
{
    TranslateBrowsePathsToNodeIdsRequest request;
    request.browse_paths = std::move(paths);
    return subject.ask<TranslateBrowsePathsToNodeIdsResponse>(std::move(request));
}

BrowsePath path_of(NodeId start, std::vector<QualifiedName> names)
{
    BrowsePath path;
    path.starting_node = std::move(start);
    for (QualifiedName& name : names) {
        RelativePathElement& element = path.relative_path.elements.emplace_back();
        element.reference_type_id = standard(id::HierarchicalReferences);
        element.include_subtypes = true;
        element.target_name = std::move(name);
    }
    return path;
}

Answer translated(Subject& subject, BrowsePath path)
{
    return operation_result(translate(subject, {std::move(path)}));
}

Answer found_target(Subject& subject)
{
    const auto response = translate(
        subject, {path_of(standard(id::ObjectsFolder),
                          {QualifiedName{0, "Server"}, QualifiedName{0, "ServerStatus"}})});
    return with(response, [](const TranslateBrowsePathsToNodeIdsResponse& each) {
        const bool is_found =
            each.results.size() == 1 && each.results[0].targets.size() == 1 &&
            each.results[0].targets[0].target_id.node_id.is(id::Server_ServerStatus);
        return expect(is_found, "another target, or none");
    });
}

Answer whole_path(Subject& subject)
{
    const auto response =
        translate(subject, {path_of(standard(id::ObjectsFolder), {QualifiedName{0, "Server"}})});
    return with(response, [](const TranslateBrowsePathsToNodeIdsResponse& each) {
        if (each.results.size() != 1 || each.results[0].targets.size() != 1) {
            return wrong("not one target");
        }
        const std::uint32_t index = each.results[0].targets[0].remaining_path_index;
        return expect(index == 0xFFFF'FFFFU, "remainingPathIndex " + std::to_string(index));
    });
}

Answer registered(Subject& subject)
{
    RegisterNodesRequest request;
    request.nodes_to_register = {some_scalar()};
    const auto response = subject.ask<RegisterNodesResponse>(std::move(request));
    if (!response) {
        return came(response.error());
    }
    if (response->registered_node_ids.size() != 1) {
        return wrong(std::to_string(response->registered_node_ids.size()) + " NodeIds");
    }
    const NodeId node = response->registered_node_ids[0];
    ReadRequest read;
    read.nodes_to_read = {client::attribute_of(node)};
    Answer answer = operation_result(subject.ask<ReadResponse>(std::move(read)));
    UnregisterNodesRequest unregister;
    unregister.nodes_to_unregister = {node};
    static_cast<void>(subject.ask<UnregisterNodesResponse>(std::move(unregister)));
    return answer;
}

template <typename Response, typename Request>
Answer empty(Subject& subject)
{
    return service_result(subject.ask<Response>(Request{}));
}

constexpr const char* browsing = "Part 4, 5.9.2.2";
constexpr const char* browse_service = "Part 4, 5.9.2.3";
constexpr const char* browse_status = "Part 4, 5.9.2.4";
constexpr const char* translate_status = "Part 4, 5.9.4.4";

const SpecRule rules[] = {
    {"browse-nothing", "Browse", "A Browse of nothing is refused", "nodesToBrowse = []",
     status::Bad_NothingToDo, browse_service, empty<BrowseResponse, BrowseRequest>},
    {"browse-too-many", "Browse", "More nodes than MaxNodesPerBrowse are refused",
     "MaxNodesPerBrowse + 1 nodes", status::Bad_TooManyOperations, browse_service, too_many},
    {"browse-node-unknown", "Browse", "A node that is not there is unknown",
     "a NodeId that does not exist", status::Bad_NodeIdUnknown, browse_status,
     [](Subject& subject) { return one(subject, children(unknown_node())); }},
    {"browse-node-null", "Browse", "The null NodeId is not a node", "nodeId = null",
     one_of(status::Bad_NodeIdUnknown, status::Bad_NodeIdInvalid), browse_status,
     [](Subject& subject) { return one(subject, children(NodeId{})); }},
    {"browse-direction-invalid", "Browse", "An unknown direction is refused", "browseDirection = 7",
     status::Bad_BrowseDirectionInvalid, browse_status,
     [](Subject& subject) {
         BrowseDescription description = children(standard(id::Server));
         description.browse_direction = static_cast<BrowseDirection>(7);
         return one(subject, std::move(description));
     }},
    {"browse-reference-type-unknown", "Browse", "A ReferenceType that is not there is refused",
     "referenceTypeId = a NodeId that does not exist", status::Bad_ReferenceTypeIdInvalid,
     browse_status,
     [](Subject& subject) {
         BrowseDescription description = children(standard(id::Server));
         description.reference_type_id = unknown_node();
         return one(subject, std::move(description));
     }},
    {"browse-reference-type-object", "Browse", "An Object is not a ReferenceType",
     "referenceTypeId = Server", status::Bad_ReferenceTypeIdInvalid, browse_status,
     [](Subject& subject) {
         BrowseDescription description = children(standard(id::Server));
         description.reference_type_id = standard(id::Server);
         return one(subject, std::move(description));
     }},
    {"browse-reference-type-null", "Browse", "Without a ReferenceType all references are returned",
     "referenceTypeId = null", "HasTypeDefinition among them", browsing, any_type},
    {"browse-subtypes", "Browse", "Without subtypes only the type itself is followed",
     "HierarchicalReferences, includeSubtypes = false", "no reference", browsing, exact_type},
    {"browse-inverse", "Browse", "Inverse follows inverse references only",
     "Server, browseDirection = Inverse", "a reference from Objects, none forward", browsing,
     inverse_only},
    {"browse-node-classes", "Browse", "nodeClassMask filters targets",
     "Server, nodeClassMask = Variable", "Variables only", browsing, only_classes},
    {"browse-result-mask", "Browse", "Only the fields of resultMask are returned",
     "Server, resultMask = 0", "NodeIds only", browsing, only_asked_fields},
    {"browse-view-unknown", "Browse", "A View that is not there is refused",
     "view = a NodeId that does not exist", status::Bad_ViewIdUnknown, browse_service,
     [](Subject& subject) { return view(subject, unknown_node()); }},
    {"browse-view-object", "Browse", "An Object is not a View", "view = Server",
     status::Bad_ViewIdUnknown, browse_service,
     [](Subject& subject) { return view(subject, standard(id::Server)); }},
    {"browse-max-references", "Browse", "requestedMaxReferencesPerNode is kept",
     "Server, requestedMaxReferencesPerNode = 1", "one reference and a continuation point",
     browsing, one_reference},
    {"next-nothing", "BrowseNext", "A BrowseNext of nothing is refused", "continuationPoints = []",
     status::Bad_NothingToDo, "Part 4, 5.9.3.3", empty<BrowseNextResponse, BrowseNextRequest>},
    {"next-unknown", "BrowseNext", "A continuation point that was not given is invalid",
     "continuationPoint = 4 bytes", status::Bad_ContinuationPointInvalid, "Part 4, 5.9.3.4",
     [](Subject& subject) {
         constexpr std::array<std::byte, 4> bytes{};
         return operation_result(next(subject, ByteString{bytes}));
     }},
    {"next-all", "BrowseNext", "BrowseNext returns every other reference once",
     "Server by one reference each", "as many references as at once", "Part 4, 5.9.3.1",
     all_by_next},
    {"next-released", "BrowseNext", "A released continuation point is invalid",
     "a continuation point after its release", status::Bad_ContinuationPointInvalid,
     "Part 4, 5.9.3.2", released},
    {"next-release-empty", "BrowseNext", "A release returns no references",
     "releaseContinuationPoints = true", "no reference", "Part 4, 5.9.3.2",
     release_returns_nothing},
    {"next-used", "BrowseNext", "A continuation point serves once",
     "the last continuation point, twice", status::Bad_ContinuationPointInvalid, "Part 4, 7.9",
     used_twice},
    {"next-other-session", "BrowseNext", "A continuation point belongs to its session",
     "a continuation point of another session", status::Bad_ContinuationPointInvalid,
     "Part 4, 5.9.3.1", of_other_session},
    {"translate-nothing", "TranslateBrowsePathsToNodeIds", "No paths are refused",
     "browsePaths = []", status::Bad_NothingToDo, "Part 4, 5.9.4.3",
     empty<TranslateBrowsePathsToNodeIdsResponse, TranslateBrowsePathsToNodeIdsRequest>},
    {"translate-target", "TranslateBrowsePathsToNodeIds", "A path leads to its node",
     "/Objects/Server/ServerStatus", "i=2256", "Part 4, 5.9.4.1", found_target},
    {"translate-whole", "TranslateBrowsePathsToNodeIds", "A whole path leaves no element",
     "/Objects/Server", "remainingPathIndex 4294967295", "Part 4, 5.9.4.2", whole_path},
    {"translate-no-match", "TranslateBrowsePathsToNodeIds", "A path to nowhere has no match",
     "/Objects/NoSuchName", status::Bad_NoMatch, translate_status,
     [](Subject& subject) {
         return translated(subject,
                           path_of(standard(id::ObjectsFolder), {QualifiedName{0, "NoSuchName"}}));
     }},
    {"translate-start-unknown", "TranslateBrowsePathsToNodeIds",
     "A starting node that is not there is unknown", "startingNode = a NodeId that does not exist",
     status::Bad_NodeIdUnknown, translate_status,
     [](Subject& subject) {
         return translated(subject, path_of(unknown_node(), {QualifiedName{0, "Server"}}));
     }},
    {"translate-empty-path", "TranslateBrowsePathsToNodeIds", "A path without elements is refused",
     "elements = []", status::Bad_NothingToDo, translate_status,
     [](Subject& subject) {
         return translated(subject, path_of(standard(id::ObjectsFolder), {}));
     }},
    {"translate-name-missing", "TranslateBrowsePathsToNodeIds",
     "An element without a name is refused", "targetName = null", status::Bad_BrowseNameInvalid,
     translate_status,
     [](Subject& subject) {
         return translated(subject, path_of(standard(id::ObjectsFolder), {QualifiedName{}}));
     }},
    {"register-nothing", "RegisterNodes", "No nodes are refused", "nodesToRegister = []",
     status::Bad_NothingToDo, "Part 4, 5.9.5.3",
     empty<RegisterNodesResponse, RegisterNodesRequest>},
    {"register-readable", "RegisterNodes", "A registered node can be read",
     "CurrentTime, then a Read of what came", status::Good, "Part 4, 5.9.5.1", registered},
    {"unregister-nothing", "UnregisterNodes", "No nodes are refused", "nodesToUnregister = []",
     status::Bad_NothingToDo, "Part 4, 5.9.6.3",
     empty<UnregisterNodesResponse, UnregisterNodesRequest>},
};

} // namespace walking
} // namespace

std::span<const SpecRule> browse_rules()
{
    return walking::rules;
}

} // namespace busbar::tool::rules
