#include <busbar/core/extension_object.hpp>

namespace busbar {

ExtensionObject::ExtensionObject(const ExtensionObject& other)
    : encoding_id_{other.encoding_id_}, type_{other.type_},
      object_{other.object_ != nullptr ? other.type_->copy(other.object_) : nullptr},
      binary_{other.binary_}, xml_{other.xml_}, body_{other.body_}
{
}

ExtensionObject::ExtensionObject(ExtensionObject&& other) noexcept
    : encoding_id_{std::move(other.encoding_id_)}, type_{std::exchange(other.type_, nullptr)},
      object_{std::exchange(other.object_, nullptr)}, binary_{std::move(other.binary_)},
      xml_{std::move(other.xml_)}, body_{std::exchange(other.body_, Body::None)}
{
}

ExtensionObject& ExtensionObject::operator=(const ExtensionObject& other)
{
    if (this != &other) {
        *this = ExtensionObject{other};
    }
    return *this;
}

ExtensionObject& ExtensionObject::operator=(ExtensionObject&& other) noexcept
{
    std::swap(encoding_id_, other.encoding_id_);
    std::swap(type_, other.type_);
    std::swap(object_, other.object_);
    std::swap(binary_, other.binary_);
    std::swap(xml_, other.xml_);
    std::swap(body_, other.body_);
    return *this;
}

ExtensionObject::~ExtensionObject()
{
    if (object_ != nullptr) {
        type_->destroy(object_);
    }
}

ExtensionObject ExtensionObject::adopt(const StructureType& type, void* object, NodeId encoding_id)
{
    ExtensionObject result;
    result.encoding_id_ = std::move(encoding_id);
    result.type_ = &type;
    result.object_ = object;
    result.body_ = Body::Object;
    return result;
}

ExtensionObject ExtensionObject::from_binary(NodeId encoding_id, ByteString body)
{
    ExtensionObject result;
    result.encoding_id_ = std::move(encoding_id);
    result.binary_ = std::move(body);
    result.body_ = Body::Binary;
    return result;
}

ExtensionObject ExtensionObject::from_xml(NodeId encoding_id, XmlElement body)
{
    ExtensionObject result;
    result.encoding_id_ = std::move(encoding_id);
    result.xml_ = std::move(body);
    result.body_ = Body::Xml;
    return result;
}

ExtensionObject ExtensionObject::from_id(NodeId encoding_id)
{
    ExtensionObject result;
    result.encoding_id_ = std::move(encoding_id);
    return result;
}

bool operator==(const ExtensionObject& a, const ExtensionObject& b)
{
    if (a.body_ != b.body_ || a.type_ != b.type_ || a.encoding_id_ != b.encoding_id_ ||
        a.binary_ != b.binary_ || a.xml_ != b.xml_) {
        return false;
    }
    return a.object_ == nullptr || a.type_->equal(a.object_, b.object_);
}

} // namespace busbar
