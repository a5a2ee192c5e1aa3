#pragma once

#include <busbar/client/attributes.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/view.hpp>

#include "subject.hpp"

namespace busbar::tool::rules {

/// A node of namespace 0.
[[nodiscard]] inline NodeId standard(std::uint32_t identifier)
{
    return NodeId{0, identifier};
}
/// A NodeId that no server has.
[[nodiscard]] inline NodeId unknown_node()
{
    return NodeId{0, "busbar.check.no.such.node"};
}
/// Server_NamespaceArray, an array of String that every server has, and a scalar.
[[nodiscard]] inline NodeId some_array()
{
    return standard(id::Server_NamespaceArray);
}
[[nodiscard]] inline NodeId some_scalar()
{
    return standard(id::Server_ServerStatus_CurrentTime);
}

[[nodiscard]] inline StatusCode status_of(StatusCode status)
{
    return status;
}
[[nodiscard]] inline StatusCode status_of(const DataValue& value)
{
    return value.status;
}
template <typename Result>
requires requires(const Result& result)
{
    result.status_code;
}
[[nodiscard]] StatusCode status_of(const Result& result)
{
    return result.status_code;
}

/// The ServiceResult.
template <typename Response>
[[nodiscard]] Answer service_result(const Result<Response>& response)
{
    return came(response ? StatusCode{status::Good} : response.error());
}
/// The status of an operation, or the ServiceResult if that is bad.
template <typename Response>
[[nodiscard]] Answer operation_result(const Result<Response>& response, std::size_t index = 0)
{
    if (!response) {
        return came(response.error());
    }
    if (response->results.size() <= index) {
        return wrong("only " + std::to_string(response->results.size()) + " results");
    }
    return came(status_of(response->results[index]));
}
/// Judges a response; the ServiceResult if that is bad.
template <typename Response, typename Judge>
[[nodiscard]] Answer with(const Result<Response>& response, Judge judge)
{
    return response ? judge(*response) : came(response.error());
}

} // namespace busbar::tool::rules
