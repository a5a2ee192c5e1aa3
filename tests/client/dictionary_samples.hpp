#pragma once

#include <string>
#include <string_view>

#include <busbar/core/types.hpp>

namespace busbar::test {

inline constexpr const char* dictionary_uri = "urn:acme:press:types";

/// A dictionary with these type descriptions.
inline std::string dictionary_of(std::string_view types, std::string_view attributes = "")
{
    return R"(<?xml version="1.0" encoding="utf-8"?>
<opc:TypeDictionary xmlns:opc="http://opcfoundation.org/BinarySchema/"
    xmlns:ua="http://opcfoundation.org/UA/" xmlns:tns="urn:acme:press:types"
    TargetNamespace="urn:acme:press:types" )" +
           std::string{attributes} + R"(>
  <opc:Documentation>What a press says of itself</opc:Documentation>
  <opc:Import Namespace="http://opcfoundation.org/UA/"/>
)" + std::string{types} +
           "</opc:TypeDictionary>";
}

/// Everything that OPC UA Binary has: nested structures, arrays, an enumeration, optional fields, a
/// union, types of namespace 0.
inline std::string press_dictionary()
{
    return dictionary_of(R"(
  <opc:EnumeratedType Name="PressMode" LengthInBits="32">
    <opc:EnumeratedValue Name="Idle" Value="0"/>
    <opc:EnumeratedValue Name="Pressing" Value="1"/>
    <opc:EnumeratedValue Name="Jammed" Value="7"/>
  </opc:EnumeratedType>
  <opc:EnumeratedType Name="Lamps" LengthInBits="8" IsOptionSet="true">
    <opc:EnumeratedValue Name="Red" Value="1"/>
  </opc:EnumeratedType>
  <opc:StructuredType Name="Position" BaseType="ua:ExtensionObject">
    <opc:Field Name="X" TypeName="opc:Double"/>
    <opc:Field Name="Y" TypeName="opc:Double"/>
  </opc:StructuredType>
  <opc:StructuredType Name="PressStatus" BaseType="ua:ExtensionObject">
    <opc:Field Name="Name" TypeName="opc:CharArray"/>
    <opc:Field Name="Mode" TypeName="tns:PressMode"/>
    <opc:Field Name="Lamps" TypeName="tns:Lamps"/>
    <opc:Field Name="Force" TypeName="ua:Range"/>
    <opc:Field Name="NoOfPath" TypeName="opc:Int32"/>
    <opc:Field Name="Path" TypeName="tns:Position" LengthField="NoOfPath"/>
    <opc:Field Name="NoOfCounts" TypeName="opc:Int32"/>
    <opc:Field Name="Counts" TypeName="opc:UInt16" LengthField="NoOfCounts"/>
    <opc:Field Name="Extra" TypeName="ua:Variant"/>
  </opc:StructuredType>
  <opc:StructuredType Name="Report" BaseType="ua:ExtensionObject">
    <opc:Field Name="OperatorSpecified" TypeName="opc:Bit"/>
    <opc:Field Name="NotesSpecified" TypeName="opc:Bit"/>
    <opc:Field Name="Reserved1" TypeName="opc:Bit" Length="30"/>
    <opc:Field Name="Number" TypeName="opc:UInt32"/>
    <opc:Field Name="Operator" TypeName="opc:String" SwitchField="OperatorSpecified"/>
    <opc:Field Name="NoOfNotes" TypeName="opc:Int32" SwitchField="NotesSpecified"/>
    <opc:Field Name="Notes" TypeName="opc:String" LengthField="NoOfNotes"
        SwitchField="NotesSpecified"/>
  </opc:StructuredType>
  <opc:StructuredType Name="Reading" BaseType="ua:Union">
    <opc:Field Name="SwitchField" TypeName="opc:UInt32"/>
    <opc:Field Name="Value" TypeName="opc:Double" SwitchField="SwitchField" SwitchValue="1"/>
    <opc:Field Name="NoOfRaw" TypeName="opc:Int32" SwitchField="SwitchField" SwitchValue="2"/>
    <opc:Field Name="Raw" TypeName="opc:Byte" LengthField="NoOfRaw" SwitchField="SwitchField"
        SwitchValue="2"/>
  </opc:StructuredType>
)");
}

} // namespace busbar::test
