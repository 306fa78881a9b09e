#include "lot/writers.h"
fg_status fg_lot_write_qif(fg_context *ctx, const fg_lot_analysis *a, FILE *out){(void)ctx;(void)a;(void)out;return FG_OK;}
fg_status fg_lot_write_dfq(fg_context *ctx, const fg_lot_analysis *a, FILE *out){(void)ctx;(void)a;(void)out;return FG_OK;}
fg_status fg_lot_index(fg_context *ctx, const char *const *f, size_t c, const char *p){(void)ctx;(void)f;(void)c;(void)p;return FG_OK;}
