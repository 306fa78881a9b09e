/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every JSON document of the program whose members are rows of tables: its schema, and its list in
 * the manual. */
#ifndef FG_MANUAL_DOCUMENTS_H
#define FG_MANUAL_DOCUMENTS_H

#include <stdio.h>

#include "core/member.h"

extern const fg_document *const fg_documents[]; /* ends with NULL */

/* Writes the document's JSON schema (draft 2020-12). */
void fg_document_write_schema(const fg_document *document, FILE *out);

/* Writes the document's members as a table of the manual. */
void fg_document_write_list(const fg_document *document, FILE *out);

#endif
